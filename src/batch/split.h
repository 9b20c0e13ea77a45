#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/error.h"

namespace retarget {

/// Division of clips into training, validation and test sets.
struct Split {
  double ratio = 0.9;  ///< Fraction of the clips for training.
  std::string seed;    ///< Seed of the pseudo-random division.
  double test = 0.0;   ///< Fraction for testing; 0: only training and validation.
};

/// The set of a clip.
enum class SplitSide : unsigned char { kTrain, kValidation, kTest };

/// Parses `0.9`, `0.9:seed`, or fractions that add up to 1: `0.8,0.1,0.1:seed`. Errors: kUsage.
[[nodiscard]] Result<Split> parse_split(const std::string& text);

/// A group of clips that must stay in one set.
struct ClipGroup {
  std::string key;          ///< `subject 5`, `KIT/3`, or the file.
  bool is_subject = false;  ///< Groups the clips of a person, otherwise those of one file.
};

/// Determines the person of a clip by name (docs/batch.md lists the rules): LAFAN1's
/// `walk1_subject5`, CMU's `07_01`, AMASS's `KIT/3/walk_poses`, otherwise the file name itself. A
/// mirror image belongs to its original (`M000001` and `_mirrored`).
/// @param source  path of the file below the given folder.
[[nodiscard]] ClipGroup group_of(const std::string& source);

/// Assigns a set to each clip. Groups stay together. In the order of the hash of seed and key, each
/// group goes to validation, otherwise to test, if that brings the set's number of clips closer to
/// its fraction; the others are for training. No set is empty if there are at least as many groups
/// as sets. The result does not depend on the order of the clips.
/// @param groups  group key of each clip, as from split_groups().
[[nodiscard]] Result<std::vector<SplitSide>> split_clips(const std::vector<std::string>& groups,
                                                         const Split& split);

/// The grouping of clips for a split.
struct SplitGroups {
  std::vector<std::string> keys;  ///< Group key of each clip.
  std::size_t by_subject = 0;     ///< Number of groups whose names identify a person.
  std::size_t by_file = 0;        ///< Number of other groups.
  std::size_t joined = 0;         ///< Number of groups by name that were merged into others.
};

/// Groups clips by name with group_of() and merges groups that share a recording: inputs with the
/// same hash, or with signatures of the same movement or its mirror image. A merged group has the
/// first of its keys. The result does not depend on the order of the clips. Without shared
/// recordings the keys come from group_of().
[[nodiscard]] SplitGroups split_groups(const std::vector<const ManifestEntry*>& clips);

}  // namespace retarget
