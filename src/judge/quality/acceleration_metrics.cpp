#include "judge/quality/acceleration_metrics.h"

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/math/spline.h"
#include "base/math/statistics.h"
#include "retarget/motion.h"
#include "robot/model/kinematic_tree.h"
#include "solve/dynamics/inertias.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// In m/s^2, of the cubic spline through the points. Accelerations are linear between frames, so the
// maximum is at a frame.
std::vector<double> accelerations_of(std::span<const Vector3d> points, double fps) {
  const std::vector<Vector3d> steps = steps_between(points);
  const std::vector<Vector3d> velocities = spline_velocities(steps);
  std::vector<double> lengths;
  lengths.reserve(points.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Vector3d square = 3.0 * steps[i] - 2.0 * velocities[i] - velocities[i + 1];
    lengths.push_back(2.0 * square.norm() * fps * fps);
  }
  const Vector3d last = 2.0 * velocities.back() + velocities[steps.size() - 1] - 3.0 * steps.back();
  lengths.push_back(2.0 * last.norm() * fps * fps);
  return lengths;
}

std::vector<Vector3d> centres_of_mass(const RobotClip& clip, const Inertias& inertias) {
  std::vector<Vector3d> centres;
  centres.reserve(static_cast<std::size_t>(clip.frame_count()));
  TreeState state(clip.robot().tree());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    state.update(clip.qpos(frame));
    Vector3d moment = Vector3d::Zero();
    for (std::size_t i = 0; i < inertias.links.size(); ++i) {
      moment += inertias.links[i].mass * (state.world_from_link[i] * inertias.links[i].com);
    }
    centres.emplace_back(moment / inertias.mass);
  }
  return centres;
}

}  // namespace

void measure_body_accelerations(const ReportBuilder& draft) {
  constexpr int kMinFrames = 3;
  const RobotClip& clip = draft.clip;
  if (clip.frame_count() < kMinFrames) return;
  const double fps = clip.rate().fps();
  std::vector<Vector3d> root;
  root.reserve(static_cast<std::size_t>(clip.frame_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    root.emplace_back(clip.qpos(frame)[0], clip.qpos(frame)[1], clip.qpos(frame)[2]);
  }
  draft.set("root_acc_p99", percentile(accelerations_of(root, fps), 99.0));
  const Inertias inertias = make_inertias(clip.robot());
  if (inertias.mass <= 0.0) return;
  std::vector<double> of_mass = accelerations_of(centres_of_mass(clip, inertias), fps);
  double squares = 0.0;
  for (const double acceleration : of_mass) squares += acceleration * acceleration;
  draft.set("com_acc_rms", std::sqrt(squares / static_cast<double>(of_mass.size())));
  draft.set("com_acc_p99", percentile(std::move(of_mass), 99.0));
}

}  // namespace retarget
