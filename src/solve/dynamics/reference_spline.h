#pragma once

#include <vector>

#include "base/math/uniform_spline.h"
#include "retarget/motion.h"
#include "retarget/reference.h"
#include "retarget/robot.h"
#include "solve/dynamics/motion_spline.h"

namespace retarget {

/// The C2 spline through a motion that keeps the limits of its joints between frames.
class ReferenceSpline {
 public:
  /// @param limits  joint ranges of the robot.
  /// @pre the clip has frames.
  ReferenceSpline(const RobotClip& clip, const LimitSet& limits);

  /// @param index  first frame of the piece, less than the last frame (0 for a single frame).
  /// @param s      fraction of the piece, in [0, 1].
  void sample(int index, double s, MotionState& state) const;

  [[nodiscard]] const std::vector<ReferenceCorrection>& corrections() const { return corrections_; }
  /// Positions and speeds that remain beyond limits because frames are, or because the correction
  /// did not succeed.
  [[nodiscard]] const std::vector<ReferenceLimit>& beyond() const { return beyond_; }

 private:
  void keep_limits(const Robot& robot, const LimitSet& limits, int link, UniformSpline& spline);
  void report_beyond(const SplineBounds& bounds, const UniformSpline& spline,
                     const std::string& joint);

  double fps_;
  std::vector<int> addresses_;          // In qpos: 0-2, then by link.
  std::vector<UniformSpline> scalars_;  // By address.
  RotationSpline rotation_;
  std::vector<ReferenceCorrection> corrections_;
  std::vector<ReferenceLimit> beyond_;
};

}  // namespace retarget
