#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/run.h"

// Link retarget::batch.
namespace RETARGET_API retarget {

/// Settings of a batch: many clips for one or several robots.
struct BatchRequest {
  Run run;  ///< Settings of every clip; the memory limit is for all clips.
  /// Sidecars and dynamics of every clip; its other members are ignored.
  RunRequest of_clip;
  std::string data_folder;           ///< Contains robots/ and configs/.
  std::vector<std::string> inputs;   ///< Files, folders, patterns, `@LIST`; or manifests to merge.
  std::vector<std::string> lists;    ///< Files with lists of names.
  std::string relative_to;           ///< Folder below which single files keep their path.
  std::vector<std::string> exclude;  ///< Shell patterns.
  std::vector<std::string> robots;   ///< Names or folders; empty: the run's own robot.
  std::string output;                ///< Output folder.
  int jobs = 0;                      ///< Clips in parallel; 0: one per processor.
  double clip_timeout_s = 0.0;       ///< Time limit per clip; 0: none.
  bool resume = false;               ///< Skip clips that are done and unchanged.
  bool redo = false;                 ///< Discard an earlier batch in the folder.
  std::string shard;                 ///< `I/N`; empty: the whole batch.
  bool quality = true;               ///< Measure the quality of the motions.
  std::vector<std::string> gates;    ///< Quality gates for the motions: changed_gates().
  std::string clips;      ///< Table of intervals of the files (docs/batch.md); empty: none.
  bool mirror = false;    ///< Add the mirror image of every clip.
  int variants = 0;       ///< Number of variations of every clip in changed scenes.
  int seed = 0;           ///< Random seed of these changes.
  bool dedupe = false;    ///< Skip duplicate clips.
  std::string split;      ///< `SHARES:SEED` (docs/batch.md); empty: no lists for training.
  bool certify = false;   ///< Write a certificate for each motion; implies sidecars and dynamics.
  bool contacts = false;  ///< Write CLIP.contacts.csv next to each motion.
  bool motion_list = false;  ///< Write motions.yaml.
  std::string pack;          ///< Name of the NPZ with all passed motions; empty: none.

  /// Called first in each worker process.
  std::function<void()> begin_worker;
};

/// Retargets all clips, each in a separate process, and writes the manifest and the summary
/// (docs/batch.md). A failed clip is not an error. Errors: kUsage for requests that are
/// contradictory or would write a file twice; a manifest that cannot be written; kInterrupted.
/// @return the number of failed clips.
[[nodiscard]] Result<std::size_t> run_batch(const BatchRequest& request, Observer& observer);

/// Merges the manifests of all shards in the output folder and the manifests given as inputs.
/// kUsage errors: options that have no effect on a merge.
/// @return the number of failed clips and missing shards.
[[nodiscard]] Result<std::size_t> merge_batch(const BatchRequest& request, Observer& observer);

/// Group of batch options in help and docs.
inline constexpr const char* kBatchGroup = "Batch";

/// The rows of a batch request, without the rows of each clip's run.
/// @param run  settings of every clip. Its memory limit applies to all running clips together.
[[nodiscard]] OptionTable batch_table(BatchRequest& request, Run& run);

}  // namespace retarget
