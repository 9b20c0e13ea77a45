#pragma once

#include <set>
#include <string>
#include <vector>

#include "batch/data_set.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/run.h"

namespace retarget {

/// One of several parts of a batch.
struct Shard {
  int index = 1;  ///< Number of this part, from 1 to `count`.
  int count = 1;  ///< Number of parts.
};

/// Parses text such as `2/8`. Errors: kUsage.
[[nodiscard]] Result<Shard> parse_shard(const std::string& text);

/// Sorts by file size, longest first; equal sizes by name.
void sort_longest_first(std::vector<BatchInput>& inputs);

/// The inputs of a shard. Inputs are sorted longest first and dealt to the shards in turn, so that
/// all have similar work. If all shards see the same files, every input is in exactly one shard.
[[nodiscard]] std::vector<BatchInput> take_shard(std::vector<BatchInput> inputs,
                                                 const Shard& shard);

/// The manifests in an output folder when a batch begins.
struct BatchManifests {
  std::string path;                           ///< The manifest that this batch writes.
  std::vector<ManifestEntry> own;             ///< Entries of that manifest.
  std::vector<ManifestEntry> others;          ///< Entries of other parts.
  std::vector<ManifestEntry> discarded = {};  ///< Entries that --redo discarded.
  bool is_new = false;                        ///< No manifest exists, not even an empty one.
};

/// The clips of a call, for its robots.
struct BatchSelection {
  std::set<std::string> clips;  ///< BatchInput::relative, including those of other shards.
  std::set<std::string> robots;

  [[nodiscard]] bool contains(const ManifestEntry& entry) const {
    return clips.contains(entry.relative) && robots.contains(entry.robot);
  }
};

/// `STEMend`, or `STEM.2-of-8end` for a part of a batch.
[[nodiscard]] std::string shard_file_name(const std::string& stem, const Shard& shard,
                                          const std::string& end);

/// Reads the manifests of earlier runs. An earlier batch in the folder requires --resume or --redo
/// (kUsage); --redo discards it.
[[nodiscard]] Result<BatchManifests> open_manifests(const std::string& folder, const Shard& shard,
                                                    const BatchRequest& request,
                                                    Observer& observer);

/// Whether a folder has a manifest of a batch or of a part.
[[nodiscard]] bool has_manifest(const std::string& folder);

/// Whether the clip of an entry is not among those of a batch, and its file no longer exists.
/// @param known  relative names of the clips that a batch found.
[[nodiscard]] bool clip_is_gone(const ManifestEntry& entry, const std::set<std::string>& known);

/// Whether an entry is a failed clip whose file no longer exists, so that nothing remains to be
/// done.
/// @param known  relative names of the clips that a batch found.
[[nodiscard]] bool is_gone(const ManifestEntry& entry, const std::set<std::string>& known);

/// Compacts the manifest of a finished batch to one line per clip and robot. If the batch is not a
/// shard, also merges the manifests of shards like merge_manifests, drops clips that are gone or
/// whose outputs another clip has replaced, applies the rules to all entries, and writes summary.csv and, for the selected motions, the
/// lists of passed ones.
[[nodiscard]] Result<void> finish_manifests(const std::string& folder, const Shard& shard,
                                            const BatchSelection& selection,
                                            const DataSetRules& rules, Observer& observer);

/// Merges the manifests of all parts in the folder, and further ones, into manifest.jsonl. Applies
/// the rules to all entries, writes summary.csv and the lists of passed motions, and removes
/// unfinished outputs of killed parts. Warns of missing shards and of clips with different options.
/// The manifests of parts are removed, unless a shard is missing.
/// @return the number of failed clips and missing shards.
[[nodiscard]] Result<std::size_t> merge_manifests(const std::string& folder,
                                                  const std::vector<std::string>& further,
                                                  const DataSetRules& rules, Observer& observer);

}  // namespace retarget
