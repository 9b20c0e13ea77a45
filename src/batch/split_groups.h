#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/manifest.h"

namespace retarget {

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
