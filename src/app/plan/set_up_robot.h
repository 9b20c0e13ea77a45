#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/robot.h"

namespace retarget {

/// Whether only the name of a model without a profile connects it with its published configuration,
/// which may be that of another robot.
[[nodiscard]] bool is_config_by_name(const std::string& config, const LoadedRobot& robot,
                                     const SolveOptions& solve);

/// The travel that is given or that the preset chooses; empty: none.
[[nodiscard]] std::string chosen_travel(const SolveOptions& options);

/// Restricts retargeting to a robot's arms (Follow::kArms). Rows of other bones and all positions
/// get zero weight, so that arms follow the human's rotations. The chest becomes the
/// configuration's root: the fixed base sees the human relative to it (HeldBase). Joints outside
/// the arms are locked at their standing positions. Errors (kConfig): a configuration without arms.
/// @pre robot.fixed_base()
[[nodiscard]] Result<void> follow_arms_alone(const Robot& robot, RobotSetup& setup);

/// Returns summary lines about the owners of the joints if only arms follow; otherwise none.
[[nodiscard]] std::vector<SummaryLine> follow_lines(const LoadedRobot& robot,
                                                    const LimitSet& limits);

/// Scale factor from the human's foot paths to the robot's.
/// Errors: the targets cannot be made (kInput, kConfig).
/// @pre the plan's robot, human, configuration and scale are known
[[nodiscard]] Result<double> foot_path_scale(const Clip& clip, const Plan& plan);

}  // namespace retarget
