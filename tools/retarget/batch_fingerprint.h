#pragma once

#include <filesystem>
#include <string>

#include "clip_run.h"
#include "options.h"

namespace retarget::cli {

/// All that decides, beside a clip itself, what becomes of it for one robot.
struct BatchFingerprint {
  std::string hash;         ///< Changes with any of it.
  std::string description;  ///< JSON, one object: tool, options, files with their hashes, robot.
};

/// Options are taken by what they mean, so that a default that is given is none that is changed;
/// files (mapping, limits, fit options, dialects, ...) by their content, the robot by its compiled
/// model and its profile, the tool by its version.
[[nodiscard]] Result<BatchFingerprint> batch_fingerprint(const BatchOptions& options,
                                                         const RunOptions& run,
                                                         const RobotSetup& setup,
                                                         const std::filesystem::path& data_folder);

}  // namespace retarget::cli
