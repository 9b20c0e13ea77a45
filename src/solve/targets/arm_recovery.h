#pragma once

#include <span>
#include <vector>

#include "retarget/pose.h"
#include "retarget/robot.h"
#include "solve/ik/ik_solver.h"
#include "solve/targets/targets.h"

namespace retarget {

/// Detects arms on a wrong branch. A shoulder reaches most poses in two ways; a frame-by-frame
/// solver that takes the wrong one while an arm is stretched runs into joint limits and stays
/// there.
class ArmRecovery {
 public:
  ArmRecovery(const IkProblem& problem, const TargetBuilder& targets);

  /// @return true if an upper arm is more than 60 degrees off its target and a search for another
  ///     configuration is due. While the arm stays off target, the number of frames until the next
  ///     search doubles, up to 256.
  /// @param qpos  solved configuration of the frame.
  [[nodiscard]] bool seen(std::span<const double> qpos, std::span<const Pose> world_from_target);

 private:
  const Robot& robot_;
  std::vector<FrameTask> arms_;
  std::vector<Pose> world_from_body_;
  int wait_ = 0;  // Frames until the next search.
  int next_wait_;
};

}  // namespace retarget
