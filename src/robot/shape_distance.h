#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// A collision shape at its place in the world.
struct PlacedShape {
  CollisionShape::Type type = CollisionShape::Type::kSphere;
  double radius = 0.0;           ///< Sphere and capsule, metres.
  double bounding_radius = 0.0;  ///< Of the sphere about the centre that holds the shape.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_axis = Eigen::Vector3d::Zero();  ///< Capsule: from the centre to an end.
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();  ///< Box.
  /// Box: its sides' directions as columns; others leave it as it is.
  Eigen::Matrix3d world_from_box = Eigen::Matrix3d::Identity();
};

[[nodiscard]] PlacedShape place(const CollisionShape& shape, const Pose& world_from_body);

/// How far two shapes are from each other.
struct ShapeDistance {
  /// Between the surfaces, metres; negative: minus the penetration depth, the least distance that
  /// one must be moved so that they only touch.
  double distance = 0.0;
  /// Unit, from a to b: the direction in which moving b changes the distance most, one for one.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  /// Points of the surfaces with on_b - on_a = distance * normal. Of touching faces and of parallel
  /// edges and axes any one pair.
  Eigen::Vector3d on_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d on_b = Eigen::Vector3d::Zero();
};

/// Exact for every pair of kinds: spheres and capsules about the nearest points of their cores;
/// boxes by convex minimisation outside and separating axes (faces and pairs of edges) inside.
/// Continuous but for the normal, which jumps where several directions are equally near; concentric
/// spheres have +z.
[[nodiscard]] ShapeDistance shape_distance(const PlacedShape& a, const PlacedShape& b);

/// The point of a shape that is lowest in the world; of several any one.
[[nodiscard]] Eigen::Vector3d lowest_point(const PlacedShape& shape);

}  // namespace retarget
