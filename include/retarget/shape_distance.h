#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "retarget/export.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// A primitive: a core (point, segment, rectangle or box) inflated by a radius. Spheres, capsules
/// and boxes have 0, 1 and 3 axes (boxes have no radius).
struct RoundedShape {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  /// Orthogonal vectors from the core's centre to its ends or sides; the first axis_count are used
  /// and none of those is zero.
  std::array<Eigen::Vector3d, 3> half_axes = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                              Eigen::Vector3d::Zero()};
  int axis_count = 0;
  double radius = 0.0;           ///< Metres.
  double bounding_radius = 0.0;  ///< Radius of the sphere about the centre that encloses the shape,
                                 ///< metres.
};

/// Converts a shape, in its body's frame.
/// @param max_rounding  shrinks a box by its smallest half size, at most by this (metres), and uses
///   that as its radius.
[[nodiscard]] RoundedShape rounded(const CollisionShape& shape, double max_rounding = 0.0);

/// Transforms a shape from frame b to frame a.
[[nodiscard]] RoundedShape placed(const RoundedShape& shape, const Pose& a_from_b);

/// Places a collision shape in the world.
[[nodiscard]] RoundedShape place(const CollisionShape& shape, const Pose& world_from_body);

/// Signed distance between two shapes.
struct ShapeDistance {
  /// Distance between the surfaces, metres. Negative: minus the penetration depth, the minimum
  /// translation that leaves the shapes just touching.
  double distance = 0.0;
  /// Unit vector from a to b: moving b along it increases the distance one for one.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  /// Surface points with on_b - on_a = distance * normal.
  Eigen::Vector3d on_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d on_b = Eigen::Vector3d::Zero();
};

/// Selects among several points that are equally near.
enum class NearestPoints : unsigned char {
  /// Any. The distance is exact.
  kExact,
  /// The middle ones, with a smooth transition for shapes that are almost parallel. Optimisers need
  /// this because rounding errors then never select the point. In return, the points are
  /// approximate for lines at less than 0.1 rad and for disjoint rectangles and boxes.
  kEven
};

/// Computes the distance of two shapes. Lines use the closed form (Ericson, "Real-Time Collision
/// Detection", section 5.1.9). Disjoint rectangles and boxes: kExact tests edges against cores,
/// where the squared distance is convex and piecewise quadratic; kEven uses alternating
/// projections. Intersecting cores use the minimum translation along a face normal or perpendicular
/// to an edge of each. The result is continuous except for the normal, which jumps where several
/// separating directions are equally short; concentric spheres get +z.
[[nodiscard]] ShapeDistance shape_distance(const RoundedShape& a, const RoundedShape& b,
                                           NearestPoints points = NearestPoints::kExact);

/// The lowest point of a shape in the world; one of them if several points are equally low.
[[nodiscard]] Eigen::Vector3d lowest_point(const RoundedShape& shape);

/// The corners of a box centred at the origin.
[[nodiscard]] inline std::array<Eigen::Vector3d, 8> box_corners(const Eigen::Vector3d& half_size) {
  std::array<Eigen::Vector3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d sign((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                               (i & 4) != 0 ? 1.0 : -1.0);
    corners[i] = half_size.cwiseProduct(sign);
  }
  return corners;
}

/// The points whose convex hull, inflated by the shape's radius, is the shape; in the body's frame.
[[nodiscard]] inline std::vector<Eigen::Vector3d> core_points(const CollisionShape& shape) {
  std::vector<Eigen::Vector3d> points;
  if (shape.type == CollisionShape::Type::kBox) {
    for (const Eigen::Vector3d& corner : box_corners(shape.half_size)) {
      points.push_back(shape.body_from_shape * corner);
    }
  } else if (shape.type == CollisionShape::Type::kCapsule) {
    for (const double end : {-shape.half_length, shape.half_length}) {
      points.push_back(shape.body_from_shape * Eigen::Vector3d(0.0, 0.0, end));
    }
  } else {
    points.push_back(shape.body_from_shape.translation);
  }
  return points;
}

}  // namespace retarget
