#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// A primitive: a core, which is a point, a segment, a rectangle or a box, with a radius around it.
/// Spheres, capsules and boxes are those with 0, 1 and 3 axes (boxes without a radius).
struct RoundedShape {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  /// Of the core, from the centre to its ends or sides, square to each other; the first axis_count
  /// count, and none of them is zero.
  std::array<Eigen::Vector3d, 3> half_axes = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                              Eigen::Vector3d::Zero()};
  int axis_count = 0;
  double radius = 0.0;           ///< Metres.
  double bounding_radius = 0.0;  ///< Of the sphere about the centre that holds the shape.
};

/// A shape in the frame of its body.
/// @param max_rounding  a box becomes one that is smaller by its thinnest half side, but by no more
///                      than this (metres), with that radius around it.
[[nodiscard]] RoundedShape rounded(const CollisionShape& shape, double max_rounding = 0.0);

/// A shape given in b, in a.
[[nodiscard]] RoundedShape placed(const RoundedShape& shape, const Pose& a_from_b);

/// A collision shape in the world.
[[nodiscard]] RoundedShape place(const CollisionShape& shape, const Pose& world_from_body);

/// How far two shapes are from each other.
struct ShapeDistance {
  /// Between the surfaces, metres; negative: minus the penetration depth, the least distance that
  /// one must be moved so that they only touch.
  double distance = 0.0;
  /// Unit, from a to b: the direction in which moving b changes the distance most, one for one.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  /// Points of the surfaces with on_b - on_a = distance * normal.
  Eigen::Vector3d on_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d on_b = Eigen::Vector3d::Zero();
};

/// Which of several points that are equally near are taken.
enum class NearestPoints : unsigned char {
  /// Any. The distance is exact.
  kExact,
  /// Those in the middle, and shapes that lie alongside each other almost go over evenly into those
  /// that do: the last bits never choose, which an optimiser needs. For that the points of lines
  /// at an angle of less than 0.1 rad, and those of rectangles and boxes that are apart, are only
  /// near to the nearest ones.
  kEven
};

/// Lines by their closed form (Ericson, "Real-Time Collision Detection", section 5.1.9). Rectangles
/// and boxes that are apart: exactly from edge to core, where the square of the distance is convex
/// and piecewise quadratic; evenly by projecting back and forth. Those whose cores meet: by the
/// least way that parts them, along the normal of a face or square to an edge of each.
/// Continuous but for the normal, which jumps where several ways out are equally long; concentric
/// spheres have +z.
[[nodiscard]] ShapeDistance shape_distance(const RoundedShape& a, const RoundedShape& b,
                                           NearestPoints points = NearestPoints::kExact);

/// The point of a shape that is lowest in the world; of several any one.
[[nodiscard]] Eigen::Vector3d lowest_point(const RoundedShape& shape);

}  // namespace retarget
