#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "batch/find_inputs.h"
#include "batch/manifest.h"
#include "batch/resume.h"
#include "batch_fingerprint.h"
#include "batch_progress.h"
#include "clip_run.h"
#include "options.h"

namespace retarget::cli {

/// A robot of a batch with all that is loaded once.
struct BatchRobot {
  RobotSetup setup;
  RunOptions run;  ///< But for source and output.
  BatchFingerprint fingerprint;
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
  std::filesystem::path data_folder;
  const FinishedClips& finished;
  ManifestWriter& manifest;
  BatchProgress& progress;
};

/// Where a clip's motion goes, below its robot's folder: the name to give to -o.
/// @param relative  BatchInput::relative.
[[nodiscard]] std::string batch_output(const OutputOptions& options, const std::string& relative);

/// Does the tasks on several threads and writes what came of them into the manifest. A clip that
/// fails is no error, a manifest that cannot be written is. Ctrl-C ends it (kInterrupted); clips
/// that were being solved are then as if they had not been begun.
[[nodiscard]] Result<void> run_batch_tasks(const std::vector<BatchTask>& tasks,
                                           const BatchOptions& options,
                                           const BatchContext& context);

}  // namespace retarget::cli
