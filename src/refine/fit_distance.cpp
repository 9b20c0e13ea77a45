#include "refine/fit_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kTiny = 1e-12;    // square metres
constexpr double kMeeting = 1e-6;  // metres; cores this near have no normal
constexpr int kProjections = 24;   // of each of two cores on the other

// the core of a shape in the world
struct Core {
  Core(const RoundedShape& shape, const Frame& world)
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

// nearest points of two lines, each c + s u with s from -1 to 1
void nearest_on_lines(const Core& a, const Core& b, Vector3d& on_a, Vector3d& on_b) {
  const Vector3d &u = a.axes[0], &v = b.axes[0];
  const Vector3d between = a.centre - b.centre;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double u_between = u.dot(between), v_between = v.dot(between);
  const double denominator = uu * vv - uv * uv;
  double s = 0.0;
  if (denominator > kTiny * uu * vv) {
    s = std::clamp((uv * v_between - vv * u_between) / denominator, -1.0, 1.0);
  }
  double t = (uv * s + v_between) / vv;
  if (t < -1.0 || t > 1.0) {
    t = std::clamp(t, -1.0, 1.0);
    s = std::clamp((uv * t - u_between) / uu, -1.0, 1.0);
  }
  on_a = a.centre + s * u;
  on_b = b.centre + t * v;
}

}  // namespace

FitDistance fit_distance(const RoundedShape& a, const Frame& world_from_a, const RoundedShape& b,
                         const Frame& world_from_b) {
  const Core core_a(a, world_from_a), core_b(b, world_from_b);
  FitDistance result;
  if (core_a.count == 1 && core_b.count == 1) {
    nearest_on_lines(core_a, core_b, result.on_a, result.on_b);
  } else {
    result.on_a = core_a.nearest(core_b.centre);
    result.on_b = core_b.nearest(result.on_a);
    const int rounds = core_a.count == 0 || core_b.count == 0 ? 1 : kProjections;
    for (int i = 0; i < rounds; ++i) {
      result.on_a = core_a.nearest(result.on_b);
      result.on_b = core_b.nearest(result.on_a);
    }
  }
  Vector3d way = result.on_a - result.on_b;
  double length = way.norm();
  if (length < kMeeting) {
    way = core_a.centre - core_b.centre;
    const double apart = way.norm();
    result.normal = apart > kMeeting ? Vector3d(way / apart) : Vector3d::UnitZ();
    length = 0.0;
  } else {
    result.normal = way / length;
  }
  result.distance = length - a.radius - b.radius;
  return result;
}

}  // namespace retarget
