#pragma once

#include <span>
#include <vector>

#include "math/rotation_spline.h"
#include "retarget/motion.h"
#include "retarget/robot.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// A configuration with its first two derivatives, in the degrees of freedom of Robot::tree().
struct MotionState {
  /// At rest.
  MotionState(const KinematicTree& tree, std::vector<double> at);
  explicit MotionState(const Robot& robot)
      : MotionState(robot.tree(), robot.zero_configuration()) {}

  std::vector<double> qpos;          ///< In the layout of Robot.
  std::vector<double> velocity;      ///< Root linear in the world, angular in its own axes, joints.
  std::vector<double> acceleration;  ///< Its rates, per second squared.
};

/// A motion between its frames, with continuous accelerations: cubic splines of the root's position
/// and of the joints (not-a-knot ends), and a RotationSpline of the root's rotation.
class MotionSpline {
 public:
  /// @param frames  one after the other, each in the layout of Robot, at least one; must stay where
  ///     they are.
  MotionSpline(const KinematicTree& tree, std::span<const double> frames, int frame_size,
               double fps);
  /// The clip must stay where it is.
  /// @pre the clip has frames
  explicit MotionSpline(const RobotClip& clip);

  /// @param index  the piece that begins with it, below the last frame (0 of a single one).
  /// @param s      in [0, 1], the way to the next.
  void sample(int index, double s, MotionState& state) const;

 private:
  [[nodiscard]] std::span<const double> frame(int index) const {
    return frames_.subspan(static_cast<std::size_t>(index) * frame_size_, frame_size_);
  }

  std::span<const double> frames_;
  std::size_t frame_size_;
  int frame_count_;
  double fps_;
  std::vector<int> addresses_;      // in qpos: 0-2, then by link
  std::vector<double> velocities_;  // frame-major, by address, per frame
  RotationSpline rotation_;
};

}  // namespace retarget
