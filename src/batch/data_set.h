#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "batch/split.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/report.h"
#include "retarget/run.h"

namespace retarget {

/// Rules that select the motions of a batch for training.
struct DataSetRules {
  std::optional<Gates> gates;  ///< Empty: keep the recorded verdicts.
  /// Whether to search for duplicate clips; empty: keep the recorded results.
  std::optional<bool> dedupe;
  std::optional<Split> split;  ///< Empty: do not write lists of a split.
  /// Whether to list only motions whose files are in place. A run has just checked or written them.
  bool check_files = false;
};

/// The rules of a request. kUsage errors: invalid gates or split, gates without measuring.
/// @param merging  only manifests are available; rules that are not given keep the recorded
///                 results.
[[nodiscard]] Result<DataSetRules> data_set_rules(const BatchRequest& request, bool merging);

/// Applies gates to recorded metrics. A gate on a metric of certificates is missed where the clip
/// has no certificate.
void judge_quality(const Gates& gates, ClipQuality& quality);

/// Applies the rules to entries again, using recorded data only; nothing is solved or measured. An
/// unmeasured clip misses the gates that name a metric.
/// @param entries  one per clip and robot, sorted by relative path.
/// @param asked    relative names of the clips among which duplicates are searched; null: all.
void judge_entries(std::vector<ManifestEntry>& entries, const DataSetRules& rules,
                   const std::set<std::string>* asked = nullptr);

/// The motions among the outputs of an entry, without sidecars, certificates and files of contacts.
/// A motion that is a folder (csv-sonic) is listed as such.
[[nodiscard]] std::vector<std::string> motions_of(const ManifestEntry& entry);

/// Whether an entry is used for training: done, no missed gate, not a duplicate.
[[nodiscard]] bool has_passed(const ManifestEntry& entry);

/// One line that states why an entry is not used: the error, or the missed gates with values and
/// bounds. Empty if the entry is used or is a duplicate.
[[nodiscard]] std::string reason_of(const ManifestEntry& entry);

/// Writes passed.txt, failed.tsv, duplicates.tsv (with `dedupe`, or if a clip was left out as a
/// duplicate) and, with a split, train.txt, validation.txt and possibly test.txt into the folder of
/// a batch. Reports their sizes. Motions whose names contain line breaks cannot be listed.
[[nodiscard]] Result<void> write_lists(const std::string& folder,
                                       const std::vector<ManifestEntry>& entries,
                                       const DataSetRules& rules, Observer& observer);

}  // namespace retarget
