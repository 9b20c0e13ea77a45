#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "base/faults.h"
#include "retarget/robot.h"

namespace retarget {

/// Reads the joint couplings of a profile from
/// `{joint: {"joint": name, "ratio": number, "offset": number}, ...}`. Couplings in a cycle are
/// faults.
[[nodiscard]] std::map<std::string, JointCoupling> couplings_from_json(
    const nlohmann::ordered_json& json, const Robot& robot, Faults& faults);

}  // namespace retarget
