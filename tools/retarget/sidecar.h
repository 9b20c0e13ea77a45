#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clip_run.h"
#include "options.h"
#include "outputs.h"
#include "retarget/report.h"
#include "run_setup.h"

namespace retarget::cli {

/// A file that a run reads.
struct ReadFile {
  std::string role;  ///< `motion`, `model`, `profile`, `mapping`, ...
  std::string file;  ///< As the user named it; below the data folder: relative to that.
  std::string path;  ///< Where it lies.
  std::string hash;  ///< `sha256:...`; empty: it cannot be hashed (standard input, not there).
};

/// All files that decide what a run makes. A robot that the options name is looked up as the run
/// does. Errors are those of the look-up; files are not opened but to be hashed.
/// @param mapping  the file that the source and the options led to.
[[nodiscard]] Result<std::vector<ReadFile>> files_read(const RunOptions& options,
                                                       const std::filesystem::path& data_folder,
                                                       const std::string& mapping);

/// The sidecar of one output: docs/formats.md describes its members.
[[nodiscard]] Result<std::string> sidecar_text(const RunOptions& options, const ClipSetup& setup,
                                               const Source& source, const WrittenFile& output,
                                               const QualityReport& report,
                                               const std::vector<ReadFile>& files);

}  // namespace retarget::cli
