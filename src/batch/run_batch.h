#pragma once

#include <functional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/options.h"
#include "run/observer.h"
#include "run/run_to_files.h"

namespace retarget {

/// Many clips, to one robot or several.
struct BatchRequest {
  Run run;  ///< Of every clip but for its file, robot and output; its memory is that of all.
  RunRequest of_clip;                ///< Whether sidecars are written.
  std::string data_folder;           ///< With robots/ and configs/.
  std::vector<std::string> inputs;   ///< Files, folders, patterns, `@LIST`; with merge: manifests.
  std::vector<std::string> lists;    ///< Files of names.
  std::string base;                  ///< Folder below which named files keep their tree.
  std::vector<std::string> exclude;  ///< Shell patterns.
  std::vector<std::string> robots;   ///< Names or folders; empty: the run's own.
  std::string output;                ///< Folder.
  int jobs = 0;                      ///< Clips at a time; 0: as many as there are processors.
  double clip_timeout_s = 0.0;       ///< After which a clip has failed; 0: never.
  bool resume = false;               ///< Skip clips that are done and unchanged.
  bool redo = false;                 ///< Forget an earlier batch in the folder.
  std::string shard;                 ///< `I/N`; empty: all of it.
  bool quality = true;               ///< Measure the motions.
  std::vector<std::string> gates;    ///< That the motions are held against: changed_gates().
  std::string clips;                 ///< Table of parts of the files (clip_table.h); empty: none.
  bool mirror = false;               ///< Every clip's mirror image as well.
  bool dedupe = false;               ///< Leave out clips that show what another shows.
  std::string split;         ///< `RATIO:SEED` (split.h); empty: not for training and validation.
  bool contacts = false;     ///< Write CLIP.contacts.csv beside each motion.
  bool motion_list = false;  ///< Write motions.yaml.
  std::string pack;          ///< Name of the NPZ of all motions that passed; empty: none.

  /// Recorded of clips that failed; as of a process that does one clip alone.
  std::function<int(ErrorKind)> exit_code;
  /// Called first in each worker process.
  std::function<void()> begin_worker;
};

/// Retargets all clips, each in a process of its own, and writes the manifest and the summary
/// (docs/batch.md). A clip that fails is no error. Errors: kUsage, requests that contradict each other
/// or would write one file twice; a manifest that cannot be written; kInterrupted.
/// @return how many clips failed.
[[nodiscard]] Result<std::size_t> run_batch(const BatchRequest& request, Observer& observer);

/// Joins the manifests of all parts in the output folder, and those that are inputs.
/// @return how many clips failed.
[[nodiscard]] Result<std::size_t> merge_batch(const BatchRequest& request, Observer& observer);

}  // namespace retarget
