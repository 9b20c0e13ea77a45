#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/plan.h"
#include "retarget/robot.h"

namespace retarget {

/// Restricts retargeting to a robot's arms (Follow::kArms). Rows of other bones and all positions
/// get zero weight, so that arms follow the human's rotations. The chest becomes the
/// configuration's root: the fixed base sees the human relative to it (HeldBase). Joints outside
/// the arms are locked at their standing positions. Errors (kConfig): a configuration without arms.
/// @pre robot.fixed_base()
[[nodiscard]] Result<void> follow_arms_alone(const Robot& robot, RobotSetup& setup);

/// Returns summary lines about the owners of the joints if only arms follow; otherwise none.
[[nodiscard]] std::vector<SummaryLine> follow_lines(const LoadedRobot& robot,
                                                    const LimitSet& limits);

}  // namespace retarget
