#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// How clips are parted into those for training and those for validation.
struct Split {
  double ratio = 0.9;  ///< Of the clips, for training.
  std::string seed;    ///< Another one parts them in another way.
};

/// `0.9:seed`, or `0.9` alone; kUsage where the text is no such thing.
[[nodiscard]] Result<Split> parse_split(const std::string& text);

/// Clips that must be on one side.
struct ClipGroup {
  std::string key;          ///< `subject 5`, `KIT/3`, or the file.
  bool is_subject = false;  ///< Of a person; else of one file.
};

/// Whose clip it is, as far as names tell (docs/batch.md lists the rules): LAFAN1's `walk1_subject5`,
/// CMU's `07_01`, AMASS's `KIT/3/walk_poses`, else the file's own name; a mirror image is its original's
/// (`M000001` and `_mirrored`).
/// @param source  the file's path below the folder that was given.
[[nodiscard]] ClipGroup group_of(const std::string& source);

/// For each clip whether it is for training. Groups stay together: in an order that the hash of seed and
/// key gives, each goes to validation if that brings its number of clips nearer to what the ratio asks.
/// Of two groups or more, both sides get one. So neither the order of clips nor anything else counts but
/// their groups.
/// @param groups  of each clip, ClipGroup::key.
[[nodiscard]] Result<std::vector<bool>> split_clips(const std::vector<std::string>& groups,
                                                    const Split& split);

}  // namespace retarget
