#pragma once

#include <vector>

#include "human/bone_map.h"
#include "human/skeleton_tree.h"

namespace retarget {

/// Bones from the hips outwards, as they must lie in line in every skeleton.
[[nodiscard]] const std::vector<std::vector<Bone>>& bone_chains();

/// The bones of a chain that are mapped and stray: their joint does not lie beyond the two bones
/// mapped before it. Empty: the chain is in line.
[[nodiscard]] std::vector<Bone> bones_out_of_line(const SkeletonTree& tree, const BoneMap& map,
                                                  const std::vector<Bone>& chain);

/// The share of mapped bones that lie in line.
[[nodiscard]] double share_in_line(const SkeletonTree& tree, const BoneMap& map);

}  // namespace retarget
