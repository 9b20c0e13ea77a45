#include "robot/shape_distance.h"

#include <algorithm>
#include <cmath>

#include "robot/box_distance.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Type = CollisionShape::Type;

// below this, metres, the direction between two points is no more than rounding
constexpr double kTouch = 1e-9;
// of two segments' directions: sin^2 of the angle below which they are looked at as parallel
constexpr double kNearlyParallel = 1e-6;

struct PointPair {
  Vector3d a, b;
};

// nearest point of a segment, centre +- half
Vector3d nearest_on_segment(const Vector3d& centre, const Vector3d& half, const Vector3d& point) {
  const double length2 = half.squaredNorm();
  if (length2 == 0.0) return centre;
  return centre + std::clamp(half.dot(point - centre) / length2, -1.0, 1.0) * half;
}

// nearest points of two segments that are not parallel, or of which one is a point
PointPair nearest_of_crossing(const PlacedShape& a, const PlacedShape& b) {
  const Vector3d offset = a.centre - b.centre;
  const double aa = a.half_axis.squaredNorm(), bb = b.half_axis.squaredNorm();
  const double ab = a.half_axis.dot(b.half_axis);
  const double ao = a.half_axis.dot(offset), bo = b.half_axis.dot(offset);
  // of the lines, then clamped to one segment after the other
  const double s_line = std::clamp((ab * bo - bb * ao) / (aa * bb - ab * ab), -1.0, 1.0);
  const double t = std::clamp((ab * s_line + bo) / bb, -1.0, 1.0);
  const double s = std::clamp((ab * t - ao) / aa, -1.0, 1.0);
  return {a.centre + s * a.half_axis, b.centre + t * b.half_axis};
}

// nearest points of two segments that are parallel or nearly so: an end of one of them, or for two
// that lie side by side the middle of what they share
PointPair nearest_of_parallel(const PlacedShape& a, const PlacedShape& b) {
  PointPair nearest{a.centre, nearest_on_segment(b.centre, b.half_axis, a.centre)};
  double least = (nearest.b - nearest.a).squaredNorm();
  const auto consider = [&](const PointPair& pair) {
    const double distance2 = (pair.b - pair.a).squaredNorm();
    if (distance2 < least) {
      least = distance2;
      nearest = pair;
    }
  };
  for (const double end : {-1.0, 1.0}) {
    const Vector3d end_of_a = a.centre + end * a.half_axis;
    const Vector3d end_of_b = b.centre + end * b.half_axis;
    consider({end_of_a, nearest_on_segment(b.centre, b.half_axis, end_of_a)});
    consider({nearest_on_segment(a.centre, a.half_axis, end_of_b), end_of_b});
  }
  const double aa = a.half_axis.squaredNorm(), bb = b.half_axis.squaredNorm();
  const double ab = a.half_axis.dot(b.half_axis);
  if (aa * bb > ab * ab) consider(nearest_of_crossing(a, b));
  return nearest;
}

PointPair nearest_of_cores(const PlacedShape& a, const PlacedShape& b) {
  if (a.type == Type::kSphere) {
    return {a.centre, nearest_on_segment(b.centre, b.half_axis, a.centre)};
  }
  if (b.type == Type::kSphere) {
    return {nearest_on_segment(a.centre, a.half_axis, b.centre), b.centre};
  }
  const double aa = a.half_axis.squaredNorm(), bb = b.half_axis.squaredNorm();
  const double ab = a.half_axis.dot(b.half_axis);
  const bool parallel = aa * bb - ab * ab <= kNearlyParallel * aa * bb;
  return parallel ? nearest_of_parallel(a, b) : nearest_of_crossing(a, b);
}

// a direction square to both cores, for cores that touch
Vector3d normal_of_touching(const PlacedShape& a, const PlacedShape& b) {
  const Vector3d across = a.half_axis.cross(b.half_axis);
  const double scale = a.half_axis.norm() * b.half_axis.norm();
  if (scale > 0.0 && across.norm() > 1e-6 * scale) return across.normalized();
  const Vector3d& axis = a.half_axis.squaredNorm() > 0.0 ? a.half_axis : b.half_axis;
  return axis.squaredNorm() > 0.0 ? axis.unitOrthogonal() : Vector3d::UnitZ();
}

ShapeDistance round_to_round(const PlacedShape& a, const PlacedShape& b) {
  const PointPair nearest = nearest_of_cores(a, b);
  const Vector3d between = nearest.b - nearest.a;
  const double apart = between.norm();
  ShapeDistance result;
  result.distance = apart - a.radius - b.radius;
  result.normal = apart > kTouch ? Vector3d(between / apart) : normal_of_touching(a, b);
  result.on_a = nearest.a + a.radius * result.normal;
  result.on_b = nearest.b - b.radius * result.normal;
  return result;
}

// a box to a sphere or a capsule
ShapeDistance box_to_round(const PlacedShape& box, const PlacedShape& round) {
  const auto box_from_world = box.world_from_box.transpose();
  const CoreDistance core =
      segment_to_box(box.half_size, box_from_world * (round.centre - box.centre),
                     box_from_world * round.half_axis);
  ShapeDistance result;
  result.distance = core.distance - round.radius;
  result.normal = box.world_from_box * core.normal;
  result.on_a = box.centre + box.world_from_box * core.on_box;
  result.on_b = result.on_a + result.distance * result.normal;
  return result;
}

ShapeDistance of_boxes(const PlacedShape& a, const PlacedShape& b) {
  const auto a_from_world = a.world_from_box.transpose();
  const CoreDistance core =
      box_to_box(a.half_size, b.half_size, a_from_world * (b.centre - a.centre),
                 a_from_world * b.world_from_box);
  ShapeDistance result;
  result.distance = core.distance;
  result.normal = a.world_from_box * core.normal;
  result.on_a = a.centre + a.world_from_box * core.on_box;
  result.on_b = result.on_a + result.distance * result.normal;
  return result;
}

}  // namespace

PlacedShape place(const CollisionShape& shape, const Pose& world_from_body) {
  PlacedShape placed;
  placed.type = shape.type;
  placed.radius = shape.radius;
  placed.centre = world_from_body * shape.body_from_shape.translation;
  switch (shape.type) {
    case Type::kSphere:
      placed.bounding_radius = shape.radius;
      break;
    case Type::kCapsule:
      placed.bounding_radius = shape.radius + shape.half_length;
      placed.half_axis = world_from_body.rotation *
                         (shape.body_from_shape.rotation * Vector3d(0, 0, shape.half_length));
      break;
    case Type::kBox:
      placed.half_size = shape.half_size;
      placed.bounding_radius = shape.half_size.norm();
      placed.world_from_box =
          (world_from_body.rotation * shape.body_from_shape.rotation).toRotationMatrix();
      break;
  }
  return placed;
}

ShapeDistance shape_distance(const PlacedShape& a, const PlacedShape& b) {
  if (a.type == Type::kBox) {
    return b.type == Type::kBox ? of_boxes(a, b) : box_to_round(a, b);
  }
  if (b.type != Type::kBox) return round_to_round(a, b);
  ShapeDistance swapped = box_to_round(b, a);
  std::swap(swapped.on_a, swapped.on_b);
  swapped.normal = -swapped.normal;
  return swapped;
}

Vector3d lowest_point(const PlacedShape& shape) {
  Vector3d lowest = shape.centre;
  switch (shape.type) {
    case Type::kSphere:
      break;
    case Type::kCapsule:
      lowest += shape.half_axis.z() > 0.0 ? Vector3d(-shape.half_axis) : shape.half_axis;
      break;
    case Type::kBox:
      for (int side = 0; side < 3; ++side) {
        const Vector3d along = shape.half_size[side] * shape.world_from_box.col(side);
        lowest += along.z() > 0.0 ? Vector3d(-along) : along;
      }
      break;
  }
  lowest.z() -= shape.radius;
  return lowest;
}

}  // namespace retarget
