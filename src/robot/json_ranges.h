#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/faults.h"
#include "retarget/robot.h"

namespace retarget {

/// A limit set from `{"joint": [lower, upper], ...}` over the model's own ranges.
/// @param what  where the ranges stand, for the faults.
[[nodiscard]] LimitSet ranges_from_json(const nlohmann::ordered_json& json, const Robot& robot,
                                        const std::string& what, Faults& faults);

}  // namespace retarget
