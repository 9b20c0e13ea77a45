#pragma once

#include <span>
#include <vector>

#include "base/math/uniform_spline.h"
#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "retarget/robot.h"

namespace retarget {

/// A configuration with its first two time derivatives, in the degrees of freedom of Robot::tree().
struct MotionState {
  /// A configuration with zero velocity and acceleration.
  MotionState(const KinematicTree& tree, std::vector<double> at);
  explicit MotionState(const Robot& robot)
      : MotionState(robot.tree(), robot.zero_configuration()) {}

  std::vector<double> qpos;  ///< Laid out as in RobotClip.
  /// Velocities per second: linear velocity of the root in the world, angular velocity in its own
  /// axes, joint velocities.
  std::vector<double> velocity;
  std::vector<double> acceleration;  ///< Time derivatives of `velocity`, per second squared.
};

/// Sets the root's rotation and its time derivatives from a spline with `fps` samples per second.
void set_root_rotation(const RotationState& turn, double fps, MotionState& state);

/// Interpolates a motion with continuous accelerations: cubic splines with not-a-knot ends for the
/// root's position and the joints, and a RotationSpline for the root's rotation.
class MotionSpline {
 public:
  /// @param frames  at least one contiguous frame, laid out as in RobotClip. The memory must
  ///     outlive the spline.
  MotionSpline(const KinematicTree& tree, std::span<const double> frames, int frame_size,
               double fps);
  /// Keeps a reference to the clip's memory.
  /// @pre the clip has frames.
  explicit MotionSpline(const RobotClip& clip);

  /// Evaluates the spline between two frames.
  /// @param index  first frame of the segment, before the last frame (0 for a single frame).
  /// @param s      position within the segment, in [0, 1].
  void sample(int index, double s, MotionState& state) const;

 private:
  [[nodiscard]] std::span<const double> frame(int index) const {
    return frames_.subspan(static_cast<std::size_t>(index) * frame_size_, frame_size_);
  }

  std::span<const double> frames_;
  std::size_t frame_size_;
  int frame_count_;
  double fps_;
  std::vector<int> addresses_;      // Addresses in qpos: root position, then joints by link.
  std::vector<double> velocities_;  // Frame-major, by address; change per frame.
  RotationSpline rotation_;
};

}  // namespace retarget
