#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// Properties of one kind of skeleton: a file of configs/skeletons (docs/skeletons.md).
///
/// Names are spelled as in files of this kind. Comparisons ignore namespaces, letter case,
/// separators and the spelling of left and right.
struct SkeletonProfile {
  std::string name;         ///< The file's name without extension, such as `mixamo`.
  std::string description;  ///< One line, human-readable.

  /// Spellings of the source joint of each canonical bone; empty: the kind has no such joint.
  BoneArray<std::vector<std::string>> names;
  std::vector<std::string> others;    ///< Further joints: fingers, ends, helpers.
  std::vector<std::string> required;  ///< Joints that every skeleton of this kind has.
  /// Substrings of which at least one must occur in the original joint names; empty: no condition.
  std::vector<std::string> marks;
  /// Joints and their parents, where they distinguish this kind from others.
  std::vector<std::pair<std::string, std::string>> parents;
  /// Directions (unit vectors, file axes) of joint offsets, where they distinguish this kind from
  /// others.
  std::vector<std::pair<std::string, Eigen::Vector3d>> directions;

  SkeletonFacts facts;
};

/// Reads a profile. A kConfig error lists every fault.
/// @param name  name of the profile.
/// @param file  file name for messages.
[[nodiscard]] Result<SkeletonProfile> parse_skeleton_profile(std::string_view text,
                                                             const std::string& name,
                                                             const std::string& file);

/// Reads all `*.json` of a folder, sorted by name. A missing or empty folder is a kConfig error.
[[nodiscard]] Result<std::vector<SkeletonProfile>> load_skeleton_profiles(
    const std::filesystem::path& folder);

}  // namespace retarget
