#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {

/// The canonical human's bones: LAFAN1's names, in its order, then the two synthetic feet.
///
/// `LeftFootMod` and `RightFootMod` stand at the ankle and are turned like the toes: the published
/// tables use them for the robot's feet, whose soles follow the ball of the human foot.
inline constexpr std::array<std::string_view, 24> kBoneNames = {
    "Hips",          "LeftUpLeg", "LeftLeg",      "LeftFoot",  "LeftToe",     "RightUpLeg",
    "RightLeg",      "RightFoot", "RightToe",     "Spine",     "Spine1",      "Spine2",
    "Neck",          "Head",      "LeftShoulder", "LeftArm",   "LeftForeArm", "LeftHand",
    "RightShoulder", "RightArm",  "RightForeArm", "RightHand", "LeftFootMod", "RightFootMod"};

inline constexpr int kBoneCount = static_cast<int>(kBoneNames.size());

/// Index into kBoneNames; `LeftToeBase` and `RightToeBase` count as the toes.
[[nodiscard]] std::optional<int> find_bone(std::string_view name);

/// kBoneNames as strings, for messages.
[[nodiscard]] const std::vector<std::string>& bone_names();

}  // namespace retarget
