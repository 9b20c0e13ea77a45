#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "human/bone_map.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// What is known of one kind of skeleton: a file of configs/skeletons (docs/skeletons.md).
///
/// Names are as the kind's own files spell them; they are compared without namespaces, letter
/// case, separators and the many spellings of left and right.
struct SkeletonProfile {
  std::string name;         ///< The file's name without extension, such as `mixamo`.
  std::string description;  ///< One line, for people.

  /// Spellings of the source joint of each canonical bone; none: the kind has no such joint.
  BoneArray<std::vector<std::string>> names;
  std::vector<std::string> others;    ///< Further joints: fingers, ends, helpers.
  std::vector<std::string> required;  ///< Joints without which it is not this kind.
  /// Texts of which at least one occurs in the joint names as written; none: no such condition.
  std::vector<std::string> marks;
  /// Joints and their parents, where that tells this kind from others.
  std::vector<std::pair<std::string, std::string>> parents;
  /// Directions (unit vectors, file axes) of joints' offsets, where that tells this kind from
  /// others.
  std::vector<std::pair<std::string, Eigen::Vector3d>> directions;

  SkeletonFacts facts;
};

/// Reads a profile; kConfig errors name every fault.
/// @param name  of the profile.
/// @param file  for messages.
[[nodiscard]] Result<SkeletonProfile> parse_skeleton_profile(std::string_view text,
                                                             const std::string& name,
                                                             const std::string& file);

/// All `*.json` of a folder, sorted by name. A missing or empty folder is a kConfig error.
[[nodiscard]] Result<std::vector<SkeletonProfile>> load_skeleton_profiles(
    const std::filesystem::path& folder);

}  // namespace retarget
