#pragma once

#include <set>
#include <string>
#include <vector>

#include "batch/data_set.h"
#include "batch/manifest.h"
#include "batch/run_batch.h"
#include "batch/shard.h"
#include "retarget/error.h"
#include "run/observer.h"

namespace retarget {

/// The manifests in an output folder when a batch begins.
struct BatchManifests {
  std::string path;                   ///< The one that this batch writes.
  std::vector<ManifestEntry> own;     ///< What it holds.
  std::vector<ManifestEntry> others;  ///< Of other parts.
};

/// `STEMend`, or `STEM.2-of-8end` for a part of a batch.
[[nodiscard]] std::string shard_file_name(const std::string& stem, const Shard& shard,
                                          const std::string& end);

/// Reads what earlier runs left. An earlier batch in the folder wants --resume or --redo (kUsage);
/// --redo forgets it.
[[nodiscard]] Result<BatchManifests> open_manifests(const std::string& folder, const Shard& shard,
                                                    const BatchRequest& request,
                                                    Observer& observer);

/// Whether an entry is of a clip that failed and whose file is no longer there: nothing is left to
/// be done about it.
/// @param known  relative names of the clips that a batch found.
[[nodiscard]] bool is_gone(const ManifestEntry& entry, const std::set<std::string>& known);

/// Brings the manifest of a batch that is through into order, one line per clip and robot. Where
/// the batch is no part of one, what the manifests of parts say goes into it as merge_manifests
/// does it, but for clips that are gone, all is held against the rules, and summary.csv and the lists
/// of what passed are written.
[[nodiscard]] Result<void> finish_manifests(const std::string& folder, const Shard& shard,
                                            const std::set<std::string>& known,
                                            const DataSetRules& rules, Observer& observer);

/// Joins the manifests of all parts in the folder, and further ones, into manifest.jsonl, holds all
/// against the rules, writes summary.csv and the lists of what passed, and removes what killed parts left of outputs that were not whole.
/// @return how many clips failed.
[[nodiscard]] Result<std::size_t> merge_manifests(const std::string& folder,
                                                  const std::vector<std::string>& further,
                                                  const DataSetRules& rules, Observer& observer);

}  // namespace retarget
