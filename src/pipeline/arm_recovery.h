#pragma once

#include <span>
#include <vector>

#include "ik/ik_solver.h"
#include "pipeline/targets.h"
#include "retarget/pose.h"
#include "retarget/robot.h"

namespace retarget {

/// Sees arms that went astray. A shoulder reaches most poses in two ways; a frame-by-frame solver that
/// takes the wrong one where an arm is stretched runs into the joints' limits and stays there.
class ArmRecovery {
 public:
  ArmRecovery(const IkProblem& problem, const TargetBuilder& targets);

  /// Whether it is time to look for another way: an upper arm is more than 60 degrees off. While it
  /// stays so, the next time is twice as many frames away as the last one, at most 256.
  /// @param qpos  of the frame, solved.
  [[nodiscard]] bool seen(std::span<const double> qpos, std::span<const Pose> world_from_target);

 private:
  const Robot& robot_;
  std::vector<FrameTask> arms_;
  std::vector<Pose> world_from_body_;
  int wait_ = 0;  // frames until the next look
  int next_wait_;
};

}  // namespace retarget
