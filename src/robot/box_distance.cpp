#include "robot/box_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// below this, metres, the direction between two points is no more than rounding
constexpr double kTouching = 1e-9;
// two edges whose directions' sine is below this say nothing that the faces do not
constexpr double kParallel = 1e-7;

Vector3d clamp_to_box(const Vector3d& half_size, const Vector3d& point) {
  return point.cwiseMax(-half_size).cwiseMin(half_size);
}

// where on centre + t * half, t in [-1, 1], the square of the distance from the box is least: it is
// convex and piecewise quadratic, with pieces that meet where a coordinate passes a side
double nearest_to_box(const Vector3d& half_size, const Vector3d& centre, const Vector3d& half) {
  const auto slope = [&](double t) {
    const Vector3d point = centre + t * half;
    return (point - clamp_to_box(half_size, point)).dot(half);
  };
  // ascending
  std::array<double, 8> ends;
  ends[0] = -1.0;
  std::size_t count = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (half[axis] == 0.0) continue;
    for (const double side : {-half_size[axis], half_size[axis]}) {
      const double t = (side - centre[axis]) / half[axis];
      if (!(t > -1.0 && t < 1.0)) continue;
      std::size_t at = count++;
      for (; ends[at - 1] > t; --at) ends[at] = ends[at - 1];
      ends[at] = t;
    }
  }
  ends[count++] = 1.0;
  double low = ends[0], slope_low = slope(low);
  if (slope_low >= 0.0) return low;
  for (std::size_t i = 1; i < count; ++i) {
    const double high = ends[i], slope_high = slope(high);
    if (slope_high >= 0.0) {
      // linear in between
      return low + (high - low) * (slope_low / (slope_low - slope_high));
    }
    low = high;
    slope_low = slope_high;
  }
  return 1.0;
}

CoreDistance between(const Vector3d& on_box, const Vector3d& other) {
  CoreDistance result;
  const Vector3d offset = other - on_box;
  result.distance = offset.norm();
  if (result.distance > 0.0) result.normal = offset / result.distance;
  result.on_box = on_box;
  return result;
}

// a segment outside of the box, or touching it
CoreDistance outside_segment(const Vector3d& half_size, const Vector3d& centre,
                             const Vector3d& half) {
  const Vector3d nearest = centre + nearest_to_box(half_size, centre, half) * half;
  return between(clamp_to_box(half_size, nearest), nearest);
}

// the point of a line (through `point`, along `direction`) that is nearest to a line along an axis
Vector3d nearest_on_line(const Vector3d& point, const Vector3d& direction,
                         const Vector3d& other_point, const Vector3d& other_direction) {
  const double dd = direction.squaredNorm(), oo = other_direction.squaredNorm();
  const double mixed = direction.dot(other_direction);
  const Vector3d offset = other_point - point;
  const double t = (direction.dot(offset) * oo - other_direction.dot(offset) * mixed) /
                   (dd * oo - mixed * mixed);
  return point + t * direction;
}

// the corner farthest in a direction
Vector3d corner_towards(const Vector3d& half_size, const Vector3d& direction) {
  Vector3d corner = half_size;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] < 0.0) corner[axis] = -corner[axis];
  }
  return corner;
}

// the way out of the box in one direction, if it is shorter by more than rounding
struct WayOut {
  double depth = std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::UnitZ();
  Vector3d deepest = Vector3d::Zero();  // point of the other

  [[nodiscard]] bool longer_than(double other) const { return other < depth - kTouching; }
  [[nodiscard]] CoreDistance result() const { return {-depth, normal, deepest + depth * normal}; }
};

CoreDistance inside_segment(const Vector3d& half_size, const Vector3d& centre,
                            const Vector3d& half) {
  WayOut out;
  // through a face
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const double depth = half_size[axis] - (sign * centre[axis] - std::abs(half[axis]));
      if (!out.longer_than(depth)) continue;
      const double end = sign * half[axis] > 0.0 ? -1.0 : half[axis] == 0.0 ? 0.0 : 1.0;
      out = {depth, sign * Vector3d::Unit(axis), centre + end * half};
    }
  }
  // across an edge
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d normal = half.cross(Vector3d::Unit(axis));
    const double length = normal.norm();
    if (length <= kParallel * half.norm()) continue;
    normal /= normal.dot(centre) < 0.0 ? -length : length;
    const double depth = normal.cwiseAbs().dot(half_size) - normal.dot(centre);
    if (!out.longer_than(depth)) continue;
    const Vector3d corner = corner_towards(half_size, normal);
    out = {depth, normal, nearest_on_line(centre, half, corner, Vector3d::Unit(axis))};
  }
  return out.result();
}

// nearest points of boxes that are apart: a corner of a to b, or an edge of b to a
CoreDistance outside_box(const Vector3d& half_size_a, const Vector3d& half_size_b,
                         const Vector3d& centre_of_b, const Matrix3d& a_from_b) {
  CoreDistance best;
  best.distance = std::numeric_limits<double>::infinity();
  const auto consider = [&best](const CoreDistance& found) {
    if (found.distance < best.distance) best = found;
  };
  for (int corner = 0; corner < 8; ++corner) {
    const auto sign = [corner](int axis) { return ((corner >> axis) & 1) != 0 ? 1.0 : -1.0; };
    const Vector3d signs(sign(0), sign(1), sign(2));
    const Vector3d in_a = signs.cwiseProduct(half_size_a);
    const Vector3d in_b = a_from_b.transpose() * (in_a - centre_of_b);
    consider(between(in_a, centre_of_b + a_from_b * clamp_to_box(half_size_b, in_b)));
    // the edge from this corner of b in each direction in which it is the lower end
    for (int axis = 0; axis < 3; ++axis) {
      if (signs[axis] > 0.0) continue;
      Vector3d middle = signs.cwiseProduct(half_size_b);
      middle[axis] = 0.0;
      consider(outside_segment(half_size_a, centre_of_b + a_from_b * middle,
                               half_size_b[axis] * a_from_b.col(axis)));
    }
  }
  return best;
}

// how far b must be moved along a unit axis of a's frame to leave a; towards where it lies
struct Overlap {
  double depth;
  Vector3d normal;
};

Overlap overlap_along(const Vector3d& axis, const Vector3d& half_size_a,
                      const Vector3d& half_size_b, const Vector3d& centre_of_b,
                      const Matrix3d& a_from_b) {
  const double apart = axis.dot(centre_of_b);
  const double reach =
      axis.cwiseAbs().dot(half_size_a) + (a_from_b.transpose() * axis).cwiseAbs().dot(half_size_b);
  return {reach - std::abs(apart), apart < 0.0 ? Vector3d(-axis) : axis};
}

}  // namespace

CoreDistance segment_to_box(const Vector3d& half_size, const Vector3d& centre,
                            const Vector3d& half) {
  const CoreDistance outside = outside_segment(half_size, centre, half);
  return outside.distance > kTouching ? outside : inside_segment(half_size, centre, half);
}

CoreDistance box_to_box(const Vector3d& half_size_a, const Vector3d& half_size_b,
                        const Vector3d& centre_of_b, const Matrix3d& a_from_b) {
  const auto overlap = [&](const Vector3d& axis) {
    return overlap_along(axis, half_size_a, half_size_b, centre_of_b, a_from_b);
  };
  WayOut out;
  // through a face of a: b's deepest point is a corner; through one of b: a's is
  for (int axis = 0; axis < 6; ++axis) {
    const bool face_of_a = axis < 3;
    const auto [depth, normal] =
        overlap(face_of_a ? Vector3d::Unit(axis) : Vector3d(a_from_b.col(axis - 3)));
    if (!out.longer_than(depth)) continue;
    if (face_of_a) {
      const Vector3d corner = corner_towards(half_size_b, a_from_b.transpose() * -normal);
      out = {depth, normal, centre_of_b + a_from_b * corner};
    } else {
      out = {depth, normal, corner_towards(half_size_a, normal) - depth * normal};
    }
  }
  // across an edge of each
  for (int edge = 0; edge < 9; ++edge) {
    const Vector3d along_a = Vector3d::Unit(edge / 3), along_b = a_from_b.col(edge % 3);
    const Vector3d across = along_a.cross(along_b);
    const double length = across.norm();
    if (length <= kParallel) continue;
    const auto [depth, normal] = overlap(across / length);
    if (!out.longer_than(depth)) continue;
    const Vector3d corner =
        centre_of_b + a_from_b * corner_towards(half_size_b, a_from_b.transpose() * -normal);
    out = {depth, normal,
           nearest_on_line(corner, along_b, corner_towards(half_size_a, normal), along_a)};
  }
  if (out.depth >= -kTouching) return out.result();
  return outside_box(half_size_a, half_size_b, centre_of_b, a_from_b);
}

}  // namespace retarget
