#pragma once

#include <string>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Formats a bone map as editable JSON: for each canonical bone, in the order of kBoneNames, the
/// name of the source joint or null.
[[nodiscard]] std::string format_bone_map(const BoneMap& map, const Skeleton& skeleton);

/// Parses the JSON of format_bone_map for a skeleton. Missing bones count as null. Missing arms or
/// legs make the map partial; this is not an error, because the file's author intends it.
/// @param file  file name for error messages
/// @return kConfig errors that list all faults: unknown bones and joints (with the closest name),
///   one joint for two bones, ambiguous joint names, bones that are not below their predecessors,
///   no hips
[[nodiscard]] Result<BoneMap> parse_bone_map(std::string_view text, const std::string& file,
                                             const Skeleton& skeleton);

/// Checks what a bone map states without a skeleton: syntax, bone names, types of values,
/// hips. A stream has no skeleton yet when its options are checked.
/// Errors (kConfig): as parse_bone_map.
[[nodiscard]] Result<void> check_bone_map(const std::string& path);

/// Reads a file and calls parse_bone_map.
[[nodiscard]] Result<BoneMap> read_bone_map(const std::string& path, const Skeleton& skeleton);

}  // namespace retarget
