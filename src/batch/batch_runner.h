#pragma once

#include <string>
#include <vector>

#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/process_pool.h"
#include "batch/progress.h"
#include "batch/resume.h"
#include "batch/run_batch.h"
#include "retarget/error.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "run/fingerprint.h"
#include "run/observer.h"
#include "run/run_to_files.h"

namespace retarget {

/// A robot of a batch with all that is loaded once.
struct BatchRobot {
  RobotSetup setup;
  Run run;  ///< But for motion and output.
  RunRequest request;
  RunFingerprint fingerprint;
  std::string name;
  std::string folder;  ///< Below the output folder, ended by `/`; empty: the output folder itself.
};

/// One clip for one robot.
struct BatchTask {
  const BatchInput* input = nullptr;
  const BatchRobot* robot = nullptr;
  /// An earlier entry whose files have other times but perhaps the same contents.
  const ManifestEntry* candidate = nullptr;
};

/// What the workers of a batch share.
struct BatchContext {
  std::string output_folder;  ///< Outputs are output_folder + "/" + ...
  const FinishedClips& finished;
  ManifestWriter& manifest;
  BatchProgress& progress;
  Observer& observer;
};

/// What a pool of processes needs to do clips, one a task.
struct ClipPool {
  ProcessPoolOptions options;         ///< But for `keep_going`.
  std::vector<std::uint64_t> memory;  ///< Of each clip, bytes.

  /// What one clip may take, GB: one that needs more than there is runs alone.
  [[nodiscard]] double memory_gb(std::size_t task) const;
};
[[nodiscard]] ClipPool clip_pool(const std::vector<const BatchInput*>& clips,
                                 const BatchRequest& request);

/// The run of a clip, but for its output: what it is of its file, and options that are for it.
[[nodiscard]] Run run_of_clip(const BatchRobot& robot, const BatchInput& clip, double memory_gb);

/// When an entry that is made now is finished: later than those of its clip that are known.
[[nodiscard]] std::string finished_now(const FinishedClips& finished, const ManifestEntry& entry);

/// Where a clip's motion goes, below its robot's folder: the name of its output.
/// @param relative  BatchInput::relative.
[[nodiscard]] std::string batch_output(const SaveOptions& options, const std::string& relative);

/// The file of its contacts, there as well. @param relative  BatchInput::relative, or `*` for all.
[[nodiscard]] std::string contacts_output(const std::string& relative);

/// Does the tasks on several threads and writes what came of them into the manifest. A clip that
/// fails is no error, a manifest that cannot be written is. Ctrl-C ends it (kInterrupted); clips
/// that were being solved are then as if they had not been begun.
[[nodiscard]] Result<void> run_batch_tasks(const std::vector<BatchTask>& tasks,
                                           const BatchRequest& request,
                                           const BatchContext& context);

}  // namespace retarget
