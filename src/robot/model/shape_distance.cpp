#include "retarget/shape_distance.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

using Eigen::Vector3d;

// Widths over which nearly equidistant points blend into each other.
struct Choice {
  double alongside;  // Squared angle between lines, rad^2.
  double tie;  // Metres: separations this similar count as equal; cores this close have no normal.
  double level;  // Height difference between an edge's ends, metres.
};
constexpr Choice kExactly{0.0, 1e-9, 1e-9}, kEvenly{1e-4, 1e-6, 1e-4};

constexpr double kSettled = 1e-24;  // Square metres: projections that move less have converged.
constexpr double kPerhapsMeeting = 0.02;  // Metres: projections onto intersecting cores end this
                                          // close.
constexpr int kProjections = 25, kBoundingProjections = 4;  // Projection rounds between two cores.

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

// Returns the point of a core nearest to another point.
Vector3d nearest(const RoundedShape& core, const Vector3d& point) {
  Vector3d result = core.centre;
  const Vector3d away = point - core.centre;
  for (int i = 0; i < core.axis_count; ++i) {
    const Vector3d& u = axis(core, i);
    result += std::clamp(u.dot(away) / u.squaredNorm(), -1.0, 1.0) * u;
  }
  return result;
}

// Returns the nearest points of two segments, a + s u and b + t v with s and t in [-1, 1]. With
// `alongside` above 0, the points of nearly parallel segments move smoothly towards a's middle.
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
  constexpr double kParallel = 1e-6;  // Squared sine of the angle.
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  return uu * vv - uv * uv <= kParallel * uu * vv;
}

// Returns the nearest points of a core and the segment middle + t half, t in [-1, 1]. The squared
// distance is convex and piecewise quadratic in t, with breakpoints at the planes of the core's
// sides.
PointPair to_segment(const RoundedShape& core, const Vector3d& middle, const Vector3d& half) {
  const auto point = [&](double t) { return Vector3d(middle + t * half); };
  const auto slope = [&](double t) { return (point(t) - nearest(core, point(t))).dot(half); };
  const auto pair = [&](double t) { return PointPair{nearest(core, point(t)), point(t)}; };
  // Breakpoints, in ascending order.
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
    // The slope is linear between breakpoints.
    if (slope_high >= 0.0) return pair(low + (high - low) * slope_low / (slope_low - slope_high));
    low = high;
    slope_low = slope_high;
  }
  return pair(1.0);
}

// Returns the core's half axes as columns; missing axes are zero.
Eigen::Matrix3d axes(const RoundedShape& core) {
  Eigen::Matrix3d columns;
  columns << core.half_axes[0], core.half_axes[1], core.half_axes[2];
  return columns;
}

// Finds near points by alternating projections from b's centre, in half-axis coordinates: a point
// of a is a.centre + u s.
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

// Exact for disjoint cores: tests b's edges against a, and a's corners against b.
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
      // Visit each edge once, from its lower end.
      if ((signs >> i & 1) != 0) continue;
      const Vector3d middle = corner(b, signs) + axis(b, i);
      if ((nearest(a, middle) - middle).norm() - axis(b, i).norm() >= min) continue;
      consider(to_segment(a, middle, axis(b, i)));
    }
  }
  // If b is a single edge, the loop above has covered it.
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

// Minimum translation that separates two intersecting cores: perpendicular to a face of one or to
// an edge of each (separating axes). Exact for boxes, and for rectangles with any core (Gottschalk,
// Lin and Manocha, "OBBTree", 1996).
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
        // Parallel edges add no axis beyond the faces' normals.
        if (across.squaredNorm() <= 1e-14 * u.squaredNorm() * v.squaredNorm()) continue;
        consider(across, 3, i, j);
      }
    }
  }

  /// Returns the penetration depth; negative if the cores do not intersect.
  [[nodiscard]] double depth() const { return depth_; }
  /// Returns the unit vector from a to b.
  [[nodiscard]] const Vector3d& normal() const { return normal_; }

  /// Returns the point on a's core at which it separates from b's: below the corner, edge middle or
  /// side middle that is deepest in the other's face; for two edges, their crossing.
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

  // Returns the point farthest along n; averages points that are equally far and blends nearly
  // equal ones.
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
    // On ties prefer a's faces, then b's, then edges; feet side by side have several equal axes.
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
  int side_ = 0;  // Owner of the separating face: 1 for a, 2 for b, 3 for a pair of edges.
  int edge_a_ = -1, edge_b_ = -1;
};

// Touching points and lines separate perpendicular to both, towards b.
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
  // For a line and an intersecting box the exact nearest points coincide, but the edges of
  // intersecting boxes may be apart.
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
