#pragma once

#include <numbers>
#include <string>

#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// A rotation offset that points a limb farther away from its direction in the model belongs to
/// another model, or to other bone axes.
inline constexpr double kWrongOffset = 75.0 * (std::numbers::pi / 180.0);

/// Compares the limbs' directions that the rotation offsets of a configuration state with those that
/// the joint axes of the model give. Twists are not compared, because published configurations
/// differ from the model by a quarter turn.
/// @return a sentence about the offsets beyond kWrongOffset; empty: none, or the model's limbs are
///   not found.
[[nodiscard]] std::string wrong_offsets(const Robot& robot, const ResolvedConfig& config);

}  // namespace retarget
