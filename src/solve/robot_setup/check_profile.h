#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "retarget/make_robot.h"
#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/robot_hands.h"
#include "solve/robot_setup/t_pose.h"

namespace retarget {

/// The findings about a robot's profile: limit sets, speed limits, soles, T-pose, couplings and
/// variants.
/// @param limbs   null: the robot's limbs are not known.
/// @param t_pose  null as `limbs`.
[[nodiscard]] std::vector<RobotFinding> profile_findings(const Robot& robot,
                                                         const RobotAnatomy* limbs,
                                                         const TPose* t_pose);

/// The speed limits that joints without their own get, such as "20 rad/s (slides: 1 m/s)".
[[nodiscard]] std::string default_speeds_text(const Robot& robot, const std::vector<int>& joints);

/// Reports speed limits (rad/s, by joint) that no motors of hinges have; nothing if they are
/// plausible.
[[nodiscard]] std::optional<std::string> odd_speeds_text(
    const Robot& robot, const std::map<std::string, double>& speeds);

/// The driven joints whose coupling has no effect, because it is not within a hand.
[[nodiscard]] std::vector<std::string> couplings_outside(const RobotHands& hands,
                                                         const Robot& robot);

/// Reports that the coupling of a driven joint has no effect.
[[nodiscard]] std::string dropped_coupling_text(const Robot& robot, const std::string& joint);

}  // namespace retarget
