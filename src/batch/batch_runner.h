#pragma once

#include <string>
#include <vector>

#include "batch/batch_report.h"
#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/process_pool.h"
#include "batch/resume.h"
#include "retarget/batch.h"
#include "retarget/error.h"
#include "retarget/fingerprint.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/run.h"

namespace retarget {

/// A robot of a batch with everything that is loaded once.
struct BatchRobot {
  RobotSetup setup;
  Run run;  ///< Run without motion and output.
  RunRequest request;
  RunFingerprint fingerprint;
  std::string name;
  std::string folder;  ///< Below the output folder, with a final `/`; empty: the output folder
                       ///< itself.
};

/// One clip for one robot.
struct BatchTask {
  const BatchInput* input = nullptr;
  const BatchRobot* robot = nullptr;
  /// An earlier entry whose files have other timestamps but possibly equal contents.
  const ManifestEntry* candidate = nullptr;
};

/// State shared by the workers of a batch.
struct BatchContext {
  std::string output_folder;  ///< Output paths are output_folder + "/" + ...
  const FinishedClips& finished;
  ManifestWriter& manifest;
  BatchProgress& progress;
  Observer& observer;
};

/// Settings of a process pool with one clip per task.
struct ClipPool {
  ProcessPoolOptions options;         ///< Options without `keep_going`.
  std::vector<std::uint64_t> memory;  ///< Bytes per clip.

  /// Memory limit of one clip in GB. A clip that needs more than the total limit runs alone.
  [[nodiscard]] double memory_gb(std::size_t task) const;
};
[[nodiscard]] ClipPool clip_pool(const std::vector<const BatchInput*>& clips,
                                 const BatchRequest& request);

/// The run of a clip without its output. Includes the clip's part of the file and its own options.
[[nodiscard]] Run run_of_clip(const BatchRobot& robot, const BatchInput& clip, double memory_gb);

/// The `finished` time of an entry that is made now; later than all known entries of its clip.
[[nodiscard]] std::string finished_now(const FinishedClips& finished, const ManifestEntry& entry);

/// Output name of a clip's motion, relative to its robot's folder.
/// @param relative  BatchInput::relative.
[[nodiscard]] std::string batch_output(const SaveOptions& options, const std::string& relative);

/// Name of the contacts file, in the same folder. @param relative  BatchInput::relative, or `*` for
/// all.
[[nodiscard]] std::string contacts_output(const std::string& relative);

/// Runs the tasks in parallel worker processes and writes the results to the manifest. A failed
/// clip is not an error; a manifest that cannot be written is. Ctrl-C stops the batch
/// (kInterrupted) and discards unfinished clips.
[[nodiscard]] Result<void> run_batch_tasks(const std::vector<BatchTask>& tasks,
                                           const BatchRequest& request,
                                           const BatchContext& context);

}  // namespace retarget
