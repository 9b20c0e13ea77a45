#include "solve/dynamics/scene_supports.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/gravity.h"
#include "retarget/so3.h"
#include "retarget/spline.h"
#include "scene/body_mass.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Heights above the ground at which `lifted` is 0 and 1, metres.
constexpr double kRests = 0.01, kLifted = 0.04;
// Step of the finite differences for the velocities and accelerations of bodies, seconds. Second
// differences of consecutive frames would amplify the noise of recorded tracks.
constexpr double kSpan = 0.05;

}  // namespace

SceneSupports::SceneSupports(const SceneWorld& world, int begin, int end)
    : world_(world),
      begin_(std::clamp(begin, 0, world.clip.frame_count - 1)),
      end_(std::clamp(end, begin_ + 1, world.clip.frame_count)) {
  for (std::size_t body = 0; body < world.body_count(); ++body) {
    row_.push_back(world.moves(body) ? static_cast<int>(moving_++) : -1);
  }
  if (moving_ == 0) return;
  for (int frame = begin_; frame < end_; ++frame) {
    for (std::size_t body = 0; body < world.body_count(); ++body) {
      if (row_[body] >= 0) motions_.push_back(motion_of(frame, body));
    }
  }
}

int SceneSupports::inside(int frame) const {
  return std::clamp(frame, begin_, end_ - 1);
}

const SceneSupports::BodyMotion* SceneSupports::motion(int frame, std::size_t body) const {
  if (row_[body] < 0) return nullptr;
  return &motions_[static_cast<std::size_t>(inside(frame) - begin_) * moving_ +
                   static_cast<std::size_t>(row_[body])];
}

SceneSupports::BodyMotion SceneSupports::motion_of(int frame, std::size_t body) const {
  BodyMotion motion;
  const double frame_time = world_.clip.rate.frame_time();
  const int half = std::max(1, static_cast<int>(std::lround(kSpan / frame_time)));
  const Pose& now = world_.clip.pose(frame, body);
  const BodyMass mass = body_mass(world_.clip.scene->bodies[body]);
  Vector3d acceleration = Vector3d::Zero();
  if (world_.clip.frame_count > 2 * half) {
    // Near the ends of the clip, uses the nearest frame with frames on both sides.
    const int middle = std::clamp(frame, half, world_.clip.frame_count - 1 - half);
    const Pose &before = world_.clip.pose(middle - half, body),
               &at = world_.clip.pose(middle, body), &after = world_.clip.pose(middle + half, body);
    const double time = half * frame_time;
    motion.velocity = (after * mass.com - before * mass.com) / (2.0 * time);
    motion.spin = log_so3(after.rotation * before.rotation.conjugate()) / (2.0 * time);
    acceleration = (after * mass.com - 2.0 * (at * mass.com) + before * mass.com) / (time * time);
  }
  const double low =
      now.translation.z() + world_.scales[body] * world_.fields[body].lowest(now.rotation);
  motion.com = now * mass.com;
  Vector3d below = motion.com;
  below.z() = low + kRests;
  const double gap = low - world_.ground_below(frame, below);
  motion.lifted = smooth_step(kRests, kLifted, gap);
  motion.force = motion.lifted * mass.mass * (acceleration + kGravity * Vector3d::UnitZ());
  return motion;
}

std::optional<std::size_t> SceneSupports::touched(int frame, const Vector3d& centre, double radius,
                                                  const Vector3d& velocity, double height,
                                                  double speed) const {
  constexpr double kHeld = 0.5;  // Degree of `lifted` above which a body supports nothing.
  const int at = inside(frame);
  std::optional<std::size_t> nearest;
  double least = height;
  for (std::size_t body = 0; body < world_.body_count(); ++body) {
    if (world_.is_beyond(at, body, centre, radius + least)) continue;
    Vector3d relative = velocity;
    if (const BodyMotion* moves = motion(at, body)) {
      if (moves->lifted > kHeld) continue;
      relative -= moves->velocity + moves->spin.cross(centre - moves->com);
    }
    if (!(relative.norm() < speed)) continue;
    const double distance = world_.distance(at, body, centre).distance - radius;
    if (distance >= least) continue;
    least = distance;
    nearest = body;
  }
  return nearest;
}

ContactPlace SceneSupports::place(int frame, const Vector3d& centre, double radius,
                                  std::size_t body) const {
  const SurfaceDistance found = world_.distance(inside(frame), body, centre);
  return {centre - radius * found.normal, found.normal};
}

void SceneSupports::find_loads(int frame, const std::vector<SupportPoint>& points,
                               const TreeState& state, double reach,
                               std::vector<LinkLoad>& loads) const {
  loads.clear();
  std::vector<double> distances;  // By load of the current body.
  const int at = inside(frame);
  for (std::size_t body = 0; body < world_.body_count(); ++body) {
    const BodyMotion* moves = motion(at, body);
    if (moves == nullptr || moves->lifted <= 0.0) continue;
    const std::size_t first = loads.size();
    distances.clear();
    for (const SupportPoint& point : points) {
      const Vector3d centre = state.world_from_link[point.link] * point.in_link;
      if (world_.is_beyond(at, body, centre, point.radius + reach)) continue;
      const SurfaceDistance found = world_.distance(at, body, centre);
      const double distance = found.distance - point.radius;
      if (distance > reach) continue;
      std::size_t i = first;
      while (i < loads.size() && loads[i].link != point.link) ++i;
      if (i == loads.size()) {
        loads.push_back({point.link, {}, {}});
        distances.push_back(std::numeric_limits<double>::infinity());
      }
      if (distance >= distances[i - first]) continue;
      loads[i].position = centre - point.radius * found.normal;
      distances[i - first] = distance;
    }
    const auto holders = static_cast<double>(loads.size() - first);
    for (std::size_t i = first; i < loads.size(); ++i) loads[i].force = moves->force / holders;
  }
}

}  // namespace retarget
