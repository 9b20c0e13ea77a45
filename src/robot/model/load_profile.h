#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "base/faults.h"
#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// Whether a profile states a fixed base, which must be known before its robot is loaded. False if
/// the file cannot be read; load_profile reports its faults.
[[nodiscard]] bool states_fixed_base(const std::string& path);

/// Reads a profile (robot.json; load_robot.h describes its keys) for a model that is already
/// loaded. Reports all faults together.
/// @param bare  the robot of the model without a profile: body names, joint names, ranges.
[[nodiscard]] Result<RobotProfile> load_profile(const std::string& path, const Robot& bare);

/// Reads the joint couplings of a profile from
/// `{joint: {"joint": name, "ratio": number, "offset": number}, ...}`. Couplings in a cycle are
/// faults.
[[nodiscard]] std::map<std::string, JointCoupling> couplings_from_json(
    const nlohmann::ordered_json& json, const Robot& robot, Faults& faults);

}  // namespace retarget
