#include "refine/fit_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kTiny = 1e-12;     // square metres
constexpr double kSettled = 1e-24;  // square metres
constexpr double kMeeting = 1e-6;   // metres; cores this near have no normal
constexpr double kPerhapsMeeting = 0.02;
constexpr double kAlongside = 1e-4;  // square of the angle between lines, radians
constexpr int kProjections = 24;     // of each of two cores on the other

// the core of a shape in the world
struct Core {
  Core(const RoundedShape& shape, const Pose& world)
      : centre(world * shape.centre), count(shape.axis_count) {
    for (int i = 0; i < count; ++i) {
      axes[static_cast<std::size_t>(i)] =
          world.rotation * shape.half_axes[static_cast<std::size_t>(i)];
    }
  }

  // the point of the core nearest to another; axes are square to each other
  [[nodiscard]] Vector3d nearest(const Vector3d& point) const {
    Vector3d result = centre;
    const Vector3d away = point - centre;
    for (int i = 0; i < count; ++i) {
      const Vector3d& axis = axes[static_cast<std::size_t>(i)];
      result += std::clamp(axis.dot(away) / axis.squaredNorm(), -1.0, 1.0) * axis;
    }
    return result;
  }

  Vector3d centre;
  std::array<Vector3d, 3> axes;
  int count;
};

// Nearest points of two lines, each c + s u with s from -1 to 1. Of lines that run alongside each
// other every point is as near; those nearest to a's middle are taken, and what is almost so goes
// over into it, or the last bits would choose.
void nearest_on_lines(const Core& a, const Core& b, Vector3d& on_a, Vector3d& on_b) {
  const Vector3d &u = a.axes[0], &v = b.axes[0];
  const Vector3d between = a.centre - b.centre;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double u_between = u.dot(between), v_between = v.dot(between);
  const double denominator = uu * vv - uv * uv + kAlongside * uu * vv;
  double s = std::clamp((uv * v_between - vv * u_between) / denominator, -1.0, 1.0);
  const double t = std::clamp((uv * s + v_between) / vv, -1.0, 1.0);
  s = std::clamp((uv * t - u_between) / uu, -1.0, 1.0);
  on_a = a.centre + s * u;
  on_b = b.centre + t * v;
}

// The least way that parts two cores that meet: square to a face of one of them or to an edge of
// each. That is exact for boxes, and for rectangles with anything (Gottschalk, Lin and Manocha,
// "OBBTree", 1996). Where the depth is not above 0 they do not meet.
class WayOut {
 public:
  WayOut(const Core& a, const Core& b) : a_(a), b_(b) {
    for (int i = 0; i < a.count; ++i) consider(axis(a, i), 1, -1, -1);
    for (int i = 0; i < b.count; ++i) consider(axis(b, i), 2, -1, -1);
    if (a.count == 2) consider(a.axes[0].cross(a.axes[1]), 1, -1, -1);
    if (b.count == 2) consider(b.axes[0].cross(b.axes[1]), 2, -1, -1);
    for (int i = 0; i < a.count; ++i) {
      for (int j = 0; j < b.count; ++j) consider(axis(a, i).cross(axis(b, j)), 3, i, j);
    }
  }

  [[nodiscard]] double depth() const { return depth_; }
  /// Unit, from b to a.
  [[nodiscard]] const Vector3d& normal() const { return normal_; }

  /// Where they touch: the corner, or the middle of the edge or side, that is deepest in the
  /// other's face; for edges where they cross.
  [[nodiscard]] Vector3d point() const {
    const Vector3d of_a = deepest(a_, -normal_, edge_a_), of_b = deepest(b_, normal_, edge_b_);
    if (side_ == 1) return a_.nearest(of_b);
    if (side_ == 2) return b_.nearest(of_a);
    Core line_a = a_, line_b = b_;
    line_a.centre = of_a;
    line_a.axes[0] = axis(a_, edge_a_);
    line_b.centre = of_b;
    line_b.axes[0] = axis(b_, edge_b_);
    Vector3d on_a, on_b;
    nearest_on_lines(line_a, line_b, on_a, on_b);
    return 0.5 * (on_a + on_b);
  }

 private:
  static const Vector3d& axis(const Core& core, int i) {
    return core.axes[static_cast<std::size_t>(i)];
  }

  static double extent(const Core& core, const Vector3d& n) {
    double sum = 0.0;
    for (int i = 0; i < core.count; ++i) sum += std::abs(n.dot(axis(core, i)));
    return sum;
  }

  // the point farthest along n, the middle of those that are equally far; in between where they
  // almost are
  static Vector3d deepest(const Core& core, const Vector3d& n, int skipped) {
    constexpr double kEqual = 1e-4;  // metres
    Vector3d result = core.centre;
    for (int i = 0; i < core.count; ++i) {
      if (i == skipped) continue;
      result += std::clamp(n.dot(axis(core, i)) / kEqual, -1.0, 1.0) * axis(core, i);
    }
    return result;
  }

  void consider(const Vector3d& way, int side, int edge_a, int edge_b) {
    constexpr double kParallel = 1e-10;  // square metres, or their square: edges have no normal
    if (way.squaredNorm() < kParallel * kParallel) return;
    const Vector3d n = way.normalized();
    const double apart = n.dot(a_.centre - b_.centre);
    const double depth = extent(a_, n) + extent(b_, n) - std::abs(apart);
    // where they are equal a's faces, then b's, then edges: feet side by side have several
    if (side_ != 0 && depth >= depth_ - kMeeting) return;
    depth_ = depth;
    normal_ = apart < 0.0 ? Vector3d(-n) : n;
    side_ = side;
    edge_a_ = edge_a;
    edge_b_ = edge_b;
  }

  const Core &a_, &b_;
  double depth_ = 0.0;
  Vector3d normal_ = Vector3d::UnitZ();
  int side_ = 0;  // whose face: 1 a's, 2 b's, 3 an edge of each
  int edge_a_ = -1, edge_b_ = -1;
};

// where lines cross they part square to both; what has no such way goes from centre to centre
Vector3d normal_of_crossing(const Core& a, const Core& b) {
  Vector3d way = Vector3d::Zero();
  if (a.count == 1 && b.count == 1) way = a.axes[0].cross(b.axes[0]);
  if (way.squaredNorm() < kTiny) way = a.centre - b.centre;
  if (way.squaredNorm() < kTiny) return Vector3d::UnitZ();
  return (way.dot(a.centre - b.centre) < 0.0 ? -1.0 : 1.0) * way.normalized();
}

}  // namespace

FitDistance fit_distance(const RoundedShape& a, const Pose& world_from_a, const RoundedShape& b,
                         const Pose& world_from_b) {
  const Core core_a(a, world_from_a), core_b(b, world_from_b);
  FitDistance result;
  if (core_a.count == 1 && core_b.count == 1) {
    nearest_on_lines(core_a, core_b, result.on_a, result.on_b);
  } else {
    result.on_a = core_a.nearest(core_b.centre);
    result.on_b = core_b.nearest(result.on_a);
    const int rounds = core_a.count == 0 || core_b.count == 0 ? 1 : kProjections;
    for (int i = 0; i < rounds; ++i) {
      const Vector3d before = result.on_b;
      result.on_a = core_a.nearest(before);
      result.on_b = core_b.nearest(result.on_a);
      if ((result.on_b - before).squaredNorm() < kSettled) break;
    }
  }
  Vector3d way = result.on_a - result.on_b;
  double length = way.norm();
  result.normal = length < kMeeting ? normal_of_crossing(core_a, core_b) : Vector3d(way / length);
  // projections of cores that meet close in on each other slowly
  if (length < kPerhapsMeeting && std::max(core_a.count, core_b.count) > 1) {
    const WayOut out(core_a, core_b);
    if (out.depth() > 0.0) {
      result.normal = out.normal();
      length = -out.depth();
      result.on_a = result.on_b = out.point();
    }
  }
  result.distance = length - a.radius - b.radius;
  return result;
}

}  // namespace retarget
