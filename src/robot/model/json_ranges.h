#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/faults.h"
#include "retarget/robot.h"

namespace retarget {

/// Reads a limit set from `{"joint": [lower, upper], ...}`; other joints keep the model's ranges.
/// @param what  describes the ranges in fault messages.
[[nodiscard]] LimitSet ranges_from_json(const nlohmann::ordered_json& json, const Robot& robot,
                                        const std::string& what, Faults& faults);

}  // namespace retarget
