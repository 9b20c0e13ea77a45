#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "batch/manifest.h"
#include "batch/run_batch.h"
#include "batch/split.h"
#include "retarget/error.h"
#include "retarget/report.h"
#include "run/observer.h"

namespace retarget {

/// Which of a batch's motions a training takes.
struct DataSetRules {
  std::optional<Gates> gates;  ///< Empty: lines stay judged as they are.
  /// Whether clips that repeat others are looked for; empty: lines keep what they say of it.
  std::optional<bool> dedupe;
  std::optional<Split> split;  ///< Empty: train.txt and validation.txt are not written.
};

/// The rules of a request. kUsage errors: gates or a split that are wrong, gates without measuring.
/// @param merging  manifests alone are there: what is not asked for stays as it was.
[[nodiscard]] Result<DataSetRules> data_set_rules(const BatchRequest& request, bool merging);

/// Holds entries against the rules again, from what they hold: nothing is solved or measured.
/// @param entries  one for each clip and robot, sorted by relative path.
/// @param asked    relative names among which repetitions are looked for; null: all.
void judge_entries(std::vector<ManifestEntry>& entries, const DataSetRules& rules,
                   const std::set<std::string>* asked = nullptr);

/// Which entries a training takes: done, no gate missed, no repetition of another.
[[nodiscard]] bool has_passed(const ManifestEntry& entry);

/// Why an entry is not taken, one line: the error, or the gates with figures and bounds. Empty: it is,
/// or it is a repetition.
[[nodiscard]] std::string reason_of(const ManifestEntry& entry);

/// Writes passed.txt, failed.tsv, duplicates.tsv (with `dedupe`, or where one was left out) and,
/// with a split, train.txt and validation.txt into the folder of a batch, and says how many there are.
[[nodiscard]] Result<void> write_lists(const std::string& folder,
                                       const std::vector<ManifestEntry>& entries,
                                       const DataSetRules& rules, Observer& observer);

}  // namespace retarget
