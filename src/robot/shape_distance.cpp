#include "robot/shape_distance.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

using Eigen::Vector3d;

// where choices between points that are equally near begin and end
struct Choice {
  double alongside;  // square of the angle between lines, radians
  double tie;        // metres: ways out that differ by less; cores this near have no normal
  double level;      // metres by which one end of an edge may be deeper than the other
};
constexpr Choice kExactly{0.0, 1e-9, 1e-9}, kEvenly{1e-4, 1e-6, 1e-4};

constexpr double kSettled = 1e-24;        // square metres
constexpr double kPerhapsMeeting = 0.02;  // metres; projections of cores that meet end this near
constexpr int kProjections = 25, kBoundingProjections = 4;  // of each of two cores on the other

struct PointPair {
  Vector3d a, b;
};

const Vector3d& axis(const RoundedShape& shape, int i) {
  return shape.half_axes[static_cast<std::size_t>(i)];
}

Vector3d corner(const RoundedShape& core, int signs) {
  Vector3d result = core.centre;
  for (int i = 0; i < core.axis_count; ++i) {
    result += ((signs >> i & 1) != 0 ? 1.0 : -1.0) * axis(core, i);
  }
  return result;
}

// the point of a core that is nearest to another
Vector3d nearest(const RoundedShape& core, const Vector3d& point) {
  Vector3d result = core.centre;
  const Vector3d away = point - core.centre;
  for (int i = 0; i < core.axis_count; ++i) {
    const Vector3d& u = axis(core, i);
    result += std::clamp(u.dot(away) / u.squaredNorm(), -1.0, 1.0) * u;
  }
  return result;
}

// Nearest points of two lines, a + s u and b + t v with s and t from -1 to 1. With `alongside` above
// 0 those of lines that are nearly parallel go over into those nearest to a's middle.
PointPair of_lines(const Vector3d& a, const Vector3d& u, const Vector3d& b, const Vector3d& v,
                   double alongside) {
  const Vector3d between = a - b;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double u_between = u.dot(between), v_between = v.dot(between);
  const double denominator = uu * vv - uv * uv + alongside * uu * vv;
  double s = std::clamp((uv * v_between - vv * u_between) / denominator, -1.0, 1.0);
  const double t = std::clamp((uv * s + v_between) / vv, -1.0, 1.0);
  s = std::clamp((uv * t - u_between) / uu, -1.0, 1.0);
  return {a + s * u, b + t * v};
}

bool parallel(const Vector3d& u, const Vector3d& v) {
  constexpr double kParallel = 1e-6;  // sin^2 of the angle
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  return uu * vv - uv * uv <= kParallel * uu * vv;
}

// nearest points of a core and the segment middle + t half, t from -1 to 1: the square of the
// distance is convex and piecewise quadratic in t, with pieces that meet where the core's sides are
PointPair to_segment(const RoundedShape& core, const Vector3d& middle, const Vector3d& half) {
  const auto point = [&](double t) { return Vector3d(middle + t * half); };
  const auto slope = [&](double t) { return (point(t) - nearest(core, point(t))).dot(half); };
  const auto pair = [&](double t) { return PointPair{nearest(core, point(t)), point(t)}; };
  // ascending
  std::array<double, 8> ends = {-1.0};
  std::size_t count = 1;
  for (int i = 0; i < core.axis_count; ++i) {
    const double along = axis(core, i).dot(half), size = axis(core, i).squaredNorm();
    if (along == 0.0) continue;
    for (const double side : {-size, size}) {
      const double t = (side - axis(core, i).dot(middle - core.centre)) / along;
      if (!(t > -1.0 && t < 1.0)) continue;
      std::size_t place = count++;
      for (; ends[place - 1] > t; --place) ends[place] = ends[place - 1];
      ends[place] = t;
    }
  }
  ends[count++] = 1.0;
  double low = -1.0, slope_low = slope(low);
  if (slope_low >= 0.0) return pair(low);
  for (std::size_t i = 1; i < count; ++i) {
    const double high = ends[i], slope_high = slope(high);
    // linear in between
    if (slope_high >= 0.0) return pair(low + (high - low) * slope_low / (slope_low - slope_high));
    low = high;
    slope_low = slope_high;
  }
  return pair(1.0);
}

// the core's axes as columns, those that it has not as zeros
Eigen::Matrix3d axes(const RoundedShape& core) {
  Eigen::Matrix3d columns;
  columns << core.half_axes[0], core.half_axes[1], core.half_axes[2];
  return columns;
}

// from b's centre back and forth, in shares of the half axes: a point of a is a.centre + u s
PointPair by_projections(const RoundedShape& a, const RoundedShape& b, int rounds) {
  const Eigen::Matrix3d u = axes(a), v = axes(b), mixed = u.transpose() * v;
  const Vector3d uu = u.colwise().squaredNorm(), vv = v.colwise().squaredNorm();
  const Vector3d between = b.centre - a.centre;
  const Vector3d to_b = u.transpose() * between, to_a = v.transpose() * -between;
  const auto shares = [](const Vector3d& along, const Vector3d& sizes) -> Vector3d {
    return (sizes.array() > 0.0)
        .select(along.cwiseQuotient(sizes), 0.0)
        .cwiseMax(-1.0)
        .cwiseMin(1.0);
  };
  Vector3d s, t = Vector3d::Zero();
  for (int i = 0; i < rounds; ++i) {
    const Vector3d before = t;
    s = shares(to_b + mixed * t, uu);
    t = shares(to_a + mixed.transpose() * s, vv);
    if ((t - before).cwiseAbs2().dot(vv) < kSettled) break;
  }
  return {a.centre + u * s, b.centre + v * t};
}

// exact for cores that are apart: an edge of b and a, or a corner of a and b
PointPair of_edges(const RoundedShape& a, const RoundedShape& b) {
  if (a.axis_count < b.axis_count) {
    const PointPair swapped = of_edges(b, a);
    return {swapped.b, swapped.a};
  }
  PointPair best = by_projections(a, b, kBoundingProjections);
  double min = (best.b - best.a).norm();
  const auto consider = [&](const PointPair& pair) {
    const double distance = (pair.b - pair.a).norm();
    if (distance >= min) return;
    min = distance;
    best = pair;
  };
  for (int signs = 0; signs < 1 << b.axis_count; ++signs) {
    for (int i = 0; i < b.axis_count; ++i) {
      // each edge once, from its lower end
      if ((signs >> i & 1) != 0) continue;
      const Vector3d middle = corner(b, signs) + axis(b, i);
      if ((nearest(a, middle) - middle).norm() - axis(b, i).norm() >= min) continue;
      consider(to_segment(a, middle, axis(b, i)));
    }
  }
  // a single edge is all of b
  for (int signs = 0; b.axis_count > 1 && signs < 1 << a.axis_count; ++signs) {
    const Vector3d of_a = corner(a, signs);
    consider({of_a, nearest(b, of_a)});
  }
  return best;
}

PointPair nearest_points(const RoundedShape& a, const RoundedShape& b, const Choice& choice) {
  const bool even = choice.alongside > 0.0;
  if (a.axis_count == 0) return {a.centre, nearest(b, a.centre)};
  if (b.axis_count == 0) return {nearest(a, b.centre), b.centre};
  if (a.axis_count == 1 && b.axis_count == 1 && (even || !parallel(axis(a, 0), axis(b, 0)))) {
    return of_lines(a.centre, axis(a, 0), b.centre, axis(b, 0), choice.alongside);
  }
  return even ? by_projections(a, b, kProjections) : of_edges(a, b);
}

// The least way that parts two cores that meet: square to a face of one of them or to an edge of
// each. That is exact for boxes, and for rectangles with anything (Gottschalk, Lin and Manocha,
// "OBBTree", 1996).
class WayOut {
 public:
  WayOut(const RoundedShape& a, const RoundedShape& b, const Choice& choice)
      : a_(a), b_(b), choice_(choice) {
    for (int i = 0; i < a.axis_count; ++i) consider(axis(a, i), 1, -1, -1);
    for (int i = 0; i < b.axis_count; ++i) consider(axis(b, i), 2, -1, -1);
    if (a.axis_count == 2) consider(axis(a, 0).cross(axis(a, 1)), 1, -1, -1);
    if (b.axis_count == 2) consider(axis(b, 0).cross(axis(b, 1)), 2, -1, -1);
    for (int i = 0; i < a.axis_count; ++i) {
      for (int j = 0; j < b.axis_count; ++j) {
        const Vector3d &u = axis(a, i), &v = axis(b, j);
        const Vector3d across = u.cross(v);
        // parallel edges say nothing that the faces do not
        if (across.squaredNorm() <= 1e-14 * u.squaredNorm() * v.squaredNorm()) continue;
        consider(across, 3, i, j);
      }
    }
  }

  /// Below 0 where the cores do not meet.
  [[nodiscard]] double depth() const { return depth_; }
  /// Unit, from a to b.
  [[nodiscard]] const Vector3d& normal() const { return normal_; }

  /// Of a's core, where it is parted from b's: under the corner, or the middle of the edge or side,
  /// that is deepest in the other's face; for edges where they cross.
  [[nodiscard]] Vector3d point() const {
    const Vector3d of_a = deepest(a_, normal_, edge_a_), of_b = deepest(b_, -normal_, edge_b_);
    if (side_ == 1) return nearest(a_, of_b) + depth_ * normal_;
    if (side_ == 2) return nearest(b_, of_a);
    const PointPair crossing =
        of_lines(of_a, axis(a_, edge_a_), of_b, axis(b_, edge_b_), choice_.alongside);
    return 0.5 * (crossing.a + crossing.b + depth_ * normal_);
  }

 private:
  static double extent(const RoundedShape& core, const Vector3d& n) {
    double sum = 0.0;
    for (int i = 0; i < core.axis_count; ++i) sum += std::abs(n.dot(axis(core, i)));
    return sum;
  }

  // the point farthest along n, the middle of those that are equally far; in between where they
  // almost are
  [[nodiscard]] Vector3d deepest(const RoundedShape& core, const Vector3d& n, int skipped) const {
    Vector3d result = core.centre;
    for (int i = 0; i < core.axis_count; ++i) {
      if (i == skipped) continue;
      result += std::clamp(n.dot(axis(core, i)) / choice_.level, -1.0, 1.0) * axis(core, i);
    }
    return result;
  }

  void consider(const Vector3d& way, int side, int edge_a, int edge_b) {
    const Vector3d n = way.normalized();
    const double apart = n.dot(b_.centre - a_.centre);
    const double depth = extent(a_, n) + extent(b_, n) - std::abs(apart);
    // where they are equal a's faces, then b's, then edges: feet side by side have several
    if (side_ != 0 && (depth_ < -choice_.tie || depth >= depth_ - choice_.tie)) return;
    depth_ = depth;
    normal_ = apart < 0.0 ? Vector3d(-n) : n;
    side_ = side;
    edge_a_ = edge_a;
    edge_b_ = edge_b;
  }

  const RoundedShape &a_, &b_;
  const Choice& choice_;
  double depth_ = 0.0;
  Vector3d normal_ = Vector3d::UnitZ();
  int side_ = 0;  // whose face: 1 a's, 2 b's, 3 an edge of each
  int edge_a_ = -1, edge_b_ = -1;
};

// points and lines that touch part square to both, towards where they lie
Vector3d normal_of_touching(const RoundedShape& a, const RoundedShape& b) {
  const RoundedShape& one = a.axis_count > 0 ? a : b;
  if (one.axis_count == 0) return Vector3d::UnitZ();
  const bool crossing = a.axis_count > 0 && b.axis_count > 0 && !parallel(axis(a, 0), axis(b, 0));
  const Vector3d way = crossing ? Vector3d(axis(a, 0).cross(axis(b, 0)).normalized())
                                : Vector3d(axis(one, 0).unitOrthogonal());
  return way.dot(b.centre - a.centre) < 0.0 ? Vector3d(-way) : way;
}

}  // namespace

RoundedShape rounded(const CollisionShape& shape, double max_rounding) {
  const Eigen::Matrix3d rotation = shape.body_from_shape.rotation.toRotationMatrix();
  RoundedShape result;
  result.centre = shape.body_from_shape.translation;
  result.radius = result.bounding_radius = shape.radius;
  Vector3d half_size = Vector3d::Zero();
  switch (shape.type) {
    case CollisionShape::Type::kSphere:
      break;
    case CollisionShape::Type::kCapsule:
      half_size.z() = shape.half_length;
      result.bounding_radius += shape.half_length;
      break;
    case CollisionShape::Type::kBox:
      result.radius = std::min(shape.half_size.minCoeff(), max_rounding);
      result.bounding_radius = shape.half_size.norm();
      half_size = shape.half_size.array() - result.radius;
      break;
  }
  for (int i = 0; i < 3; ++i) {
    if (half_size[i] <= 0.0) continue;
    result.half_axes[static_cast<std::size_t>(result.axis_count++)] =
        half_size[i] * rotation.col(i);
  }
  return result;
}

RoundedShape placed(const RoundedShape& shape, const Pose& a_from_b) {
  RoundedShape result = shape;
  const Eigen::Matrix3d rotation = a_from_b.rotation.toRotationMatrix();
  result.centre = a_from_b.translation + rotation * shape.centre;
  for (int i = 0; i < shape.axis_count; ++i) {
    result.half_axes[static_cast<std::size_t>(i)] = rotation * axis(shape, i);
  }
  return result;
}

RoundedShape place(const CollisionShape& shape, const Pose& world_from_body) {
  return placed(rounded(shape), world_from_body);
}

ShapeDistance shape_distance(const RoundedShape& a, const RoundedShape& b, NearestPoints points) {
  const bool exact = points == NearestPoints::kExact;
  const Choice& choice = exact ? kExactly : kEvenly;
  const auto [fewer, more] = std::minmax(a.axis_count, b.axis_count);
  ShapeDistance found;
  const auto finish = [&](const Vector3d& of_core_a, double apart, const Vector3d& normal) {
    found.distance = apart - a.radius - b.radius;
    found.normal = normal;
    found.on_a = of_core_a + a.radius * normal;
    found.on_b = found.on_a + found.distance * normal;
    return found;
  };
  const auto part = [&] {
    const WayOut out(a, b, choice);
    const bool meet = out.depth() > -choice.tie;
    if (meet) finish(out.point(), -out.depth(), out.normal());
    return meet;
  };
  // exact points of a line and a box that meet are one, but edges of boxes that meet may be apart
  const bool boxes = exact && fewer > 1;
  if (boxes && part()) return found;
  const PointPair pair = nearest_points(a, b, choice);
  const Vector3d way = pair.b - pair.a;
  const double apart = way.norm();
  if (!boxes && more > 1 && apart < (exact ? choice.tie : kPerhapsMeeting) && part()) return found;
  return finish(pair.a, apart,
                apart > choice.tie ? Vector3d(way / apart) : normal_of_touching(a, b));
}

Vector3d lowest_point(const RoundedShape& shape) {
  Vector3d lowest = shape.centre;
  for (int i = 0; i < shape.axis_count; ++i) {
    lowest += axis(shape, i).z() > 0.0 ? Vector3d(-axis(shape, i)) : axis(shape, i);
  }
  lowest.z() -= shape.radius;
  return lowest;
}

}  // namespace retarget
