#pragma once

#include <functional>
#include <memory>

#include "retarget/base/result.h"
#include "retarget/human/human_clip.h"
#include "retarget/ik/ik_solver.h"
#include "retarget/pipeline/ik_tables.h"
#include "retarget/robot/limits.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

/// Which implementation of the inverse kinematics runs; both take the same steps.
enum class IkEngine { kFast, kReference };

/// How a human clip becomes a robot clip.
struct RetargetOptions {
  IkEngine engine = IkEngine::kFast;
  IkOptions ik;
  /// Asked before every frame with its number; false stops the run with ErrorKind::kInterrupted.
  std::function<bool(int frame)> keep_going;
};

/// A robot clip and what it took to solve it.
struct RetargetResult {
  RobotClip clip;
  long steps = 0;           ///< IK steps of all frames and passes.
  int most_steps = 0;       ///< Of a single frame.
  double mean_error = 0.0;  ///< Mean over frames of the last pass's final unweighted error norm.
};

/// Retargets frame by frame with the published two-pass method: the first frame starts from the
/// model's zero configuration (qpos0), every other from the frame before.
///
/// Errors: a fault in the mapping, or weights that lead to values that are not finite (kConfig); a
/// mapped bone that the clip lacks, or positions too large to compute with (kInput).
/// @param clip_name  the clip's file, for messages.
[[nodiscard]] Result<RetargetResult> retarget(const HumanClip& human, const std::string& clip_name,
                                              const std::shared_ptr<const Robot>& robot,
                                              const IkTables& tables, const LimitSet& limits,
                                              const RetargetOptions& options = {});

}  // namespace retarget
