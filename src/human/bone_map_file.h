#pragma once

#include <string>
#include <string_view>

#include "human/bone_map.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// The editable form of a bone map, JSON: the name of the source joint, or null, per canonical
/// bone in the order of kBoneNames.
[[nodiscard]] std::string format_bone_map(const BoneMap& map, const Skeleton& skeleton);

/// Writes that to a file; an empty path: nowhere.
[[nodiscard]] Result<void> save_bone_map(const std::string& path, const BoneMap& map,
                                         const Skeleton& skeleton);

/// Reads such a text for a skeleton. Bones that are left out count as null. Errors are of kind
/// kConfig and name every fault: unknown bones and joints (with the nearest name), one joint for
/// two bones, names that several joints have, bones out of line, missing hips.
/// Missing arms or legs only make the map partial: who wrote the file means it.
/// @param file  for messages.
[[nodiscard]] Result<BoneMap> parse_bone_map(std::string_view text, const std::string& file,
                                             const Skeleton& skeleton);

/// parse_bone_map of a file.
[[nodiscard]] Result<BoneMap> read_bone_map(const std::string& path, const Skeleton& skeleton);

}  // namespace retarget
