#include "solve/dynamics/motion_spline.h"

#include <Eigen/Core>
#include <algorithm>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "retarget/root_pose.h"
#include "retarget/spline.h"

namespace retarget {
namespace {

// Reads the values at up to three addresses; missing ones are 0.
Eigen::Vector3d three(std::span<const double> qpos, std::span<const int> addresses) {
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < addresses.size(); ++i)
    values[static_cast<int>(i)] = qpos[addresses[i]];
  return values;
}

}  // namespace

MotionState::MotionState(const KinematicTree& tree, std::vector<double> at)
    : qpos(std::move(at)), velocity(tree.dof_count(), 0.0), acceleration(tree.dof_count(), 0.0) {}

void set_root_rotation(const RotationState& turn, double fps, MotionState& state) {
  set_root_rotation(state.qpos, turn.rotation);
  for (int k = 0; k < 3; ++k) {
    state.velocity[3 + k] = fps * turn.velocity[k];
    state.acceleration[3 + k] = fps * fps * turn.acceleration[k];
  }
}

MotionSpline::MotionSpline(const RobotClip& clip)
    : MotionSpline(
          clip.robot().tree(),
          {clip.qpos(0).data(), static_cast<std::size_t>(clip.frame_count()) * clip.qpos(0).size()},
          static_cast<int>(clip.qpos(0).size()), clip.rate().fps()) {}

MotionSpline::MotionSpline(const KinematicTree& tree, std::span<const double> frames,
                           int frame_size, double fps)
    : frames_(frames),
      frame_size_(static_cast<std::size_t>(frame_size)),
      frame_count_(static_cast<int>(frames.size() / frame_size_)),
      fps_(fps),
      addresses_{0, 1, 2} {
  std::vector<Eigen::Quaterniond> rotations;
  for (int t = 0; t < frame_count_; ++t) {
    rotations.push_back(root_rotation(frame(t)).normalized());
  }
  rotation_ = RotationSpline(rotations);
  const auto& links = tree.links();
  for (std::size_t i = 1; i < links.size(); ++i) addresses_.push_back(links[i].qpos_address);
  velocities_.resize(addresses_.size() * static_cast<std::size_t>(frame_count_));
  std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(frame_count_));
  for (std::size_t first = 0; first < addresses_.size(); first += 3) {
    const auto of =
        std::span(addresses_).subspan(first, std::min<std::size_t>(3, addresses_.size() - first));
    for (int t = 0; t < frame_count_; ++t)
      points[static_cast<std::size_t>(t)] = three(frame(t), of);
    const std::vector<Eigen::Vector3d> found = spline_velocities(steps_between(points));
    for (std::size_t t = 0; t < found.size(); ++t) {
      for (std::size_t k = 0; k < of.size(); ++k) {
        velocities_[t * addresses_.size() + first + k] = found[t][static_cast<int>(k)];
      }
    }
  }
}

void MotionSpline::sample(int index, double s, MotionState& state) const {
  const double fps = fps_;
  const int next = std::min(index + 1, frame_count_ - 1);
  const auto from = frame(index), to = frame(next);
  const double* const v0 = velocities_.data() + static_cast<std::size_t>(index) * addresses_.size();
  const double* const v1 = velocities_.data() + static_cast<std::size_t>(next) * addresses_.size();
  for (std::size_t i = 0; i < addresses_.size(); ++i) {
    const int at = addresses_[i];
    const double step = to[at] - from[at];
    const double square = 3.0 * step - 2.0 * v0[i] - v1[i], cube = v0[i] + v1[i] - 2.0 * step;
    const std::size_t dof = i < 3 ? i : i + 3;
    state.qpos[at] = from[at] + s * (v0[i] + s * (square + s * cube));
    state.velocity[dof] = fps * (v0[i] + s * (2.0 * square + 3.0 * s * cube));
    state.acceleration[dof] = fps * fps * (2.0 * square + 6.0 * s * cube);
  }
  set_root_rotation(rotation_.at(index, s), fps, state);
}

}  // namespace retarget
