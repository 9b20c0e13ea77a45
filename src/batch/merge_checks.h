#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/run.h"

namespace retarget {

/// Refuses options that have no effect when manifests are merged. Errors: kUsage.
[[nodiscard]] Result<void> check_merge(const BatchRequest& request);

/// Shards whose manifests are not among those to merge.
struct MissingShards {
  std::size_t count = 0;
  std::vector<std::string> names;  ///< The first ones: `manifest.2-of-3.jsonl`.
};

/// Finds the shards without a manifest from the names of the other manifests.
/// @param manifests  files to merge.
/// @param merged     entries of the manifest of the whole batch. If it has clips that no other
///                   manifest has, it comes from a complete merge, and no shard is missing.
/// @param others     entries of the other manifests.
[[nodiscard]] MissingShards missing_shards(const std::vector<std::string>& manifests,
                                           const std::vector<ManifestEntry>& merged,
                                           const std::vector<ManifestEntry>& others);

/// Warns that shards are missing. @param folder  output folder of the batch.
void warn_of_missing_shards(const MissingShards& missing, const std::string& folder,
                            Observer& observer);

/// Warns if clips of a robot were made with different options.
/// @param path  manifest of the whole batch.
void warn_of_mixed_options(const std::vector<ManifestEntry>& entries, const std::string& path,
                           Observer& observer);

}  // namespace retarget
