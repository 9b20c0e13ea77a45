#pragma once

#include <vector>

#include "base/math/uniform_spline.h"
#include "retarget/motion.h"
#include "retarget/reference.h"
#include "retarget/robot.h"
#include "solve/dynamics/motion_spline.h"

namespace retarget {

/// A C2 spline through a motion whose joints also keep their limits between frames.
class ReferenceSpline {
 public:
  /// @param limits  joint ranges of the robot.
  /// @pre the clip has frames.
  ReferenceSpline(const RobotClip& clip, const LimitSet& limits);

  /// Evaluates the spline between two frames.
  /// @param index  first frame of the segment, before the last frame (0 for a single frame).
  /// @param s      position within the segment, in [0, 1].
  void sample(int index, double s, MotionState& state) const;

  /// Joints whose spline was changed to keep its limits.
  [[nodiscard]] const std::vector<ReferenceCorrection>& corrections() const { return corrections_; }
  /// Positions and speeds that remain beyond limits, because a frame itself is beyond them or the
  /// correction failed.
  [[nodiscard]] const std::vector<ReferenceLimit>& beyond() const { return beyond_; }

 private:
  void keep_limits(const Robot& robot, const LimitSet& limits, int link, UniformSpline& spline);
  void report_beyond(const SplineBounds& bounds, const UniformSpline& spline,
                     const std::string& joint);

  double fps_;
  std::vector<int> addresses_;          // Addresses in qpos: root position, then joints by link.
  std::vector<UniformSpline> scalars_;  // By address.
  RotationSpline rotation_;
  std::vector<ReferenceCorrection> corrections_;
  std::vector<ReferenceLimit> beyond_;
};

}  // namespace retarget
