#pragma once

#include <span>
#include <vector>

#include "math/rotation_spline.h"
#include "retarget/motion.h"

namespace retarget {

/// A configuration with its first two derivatives, in the degrees of freedom of Robot::tree().
struct MotionState {
  explicit MotionState(const Robot& robot);

  std::vector<double> qpos;          ///< In the layout of Robot.
  std::vector<double> velocity;      ///< Root linear in the world, angular in its own axes, joints.
  std::vector<double> acceleration;  ///< Its rates, per second squared.
};

/// A motion between its frames, with continuous accelerations: cubic splines of the root's position
/// and of the joints (not-a-knot ends), and a RotationSpline of the root's rotation.
class MotionSpline {
 public:
  /// The clip must stay where it is.
  /// @pre the clip has frames
  explicit MotionSpline(const RobotClip& clip);

  /// @param frame  the piece that begins with it, below the last frame (0 of a single one).
  /// @param s      in [0, 1], the way to the next.
  void sample(int frame, double s, MotionState& state) const;

 private:
  const RobotClip* clip_;
  std::vector<int> addresses_;      // in qpos: 0-2, then by link
  std::vector<double> velocities_;  // frame-major, by address, per frame
  RotationSpline rotation_;
};

}  // namespace retarget
