#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/solve.h"
#include "run/outputs.h"

namespace retarget {

/// A file that a run reads.
struct ReadFile {
  std::string role;  ///< `motion`, `model`, `profile`, `mapping`, or the option that names it.
  std::string file;  ///< As the user named it; below the data folder: relative to that.
  std::string path;  ///< Where it lies.
  std::string hash;  ///< `sha256:...`; empty: it cannot be hashed (standard input, a pipe).
};

/// All files that decide what a run makes, hashed.
/// @param config  the retargeting configuration's file that was taken.
[[nodiscard]] Result<std::vector<ReadFile>> files_read(const Run& run, const LoadedRobot& robot,
                                                       const std::string& config);

/// The sidecar of one output: docs/formats.md describes its members.
/// @param mirror  RunRequest::mirror.
[[nodiscard]] std::string sidecar_text(const Run& run, const Motion& motion,
                                       const WrittenFile& output, const QualityReport& report,
                                       const std::vector<ReadFile>& files, bool mirror = false);

/// What a sidecar says of a run.
struct Sidecar {
  std::string version;  ///< Of the tool.
  std::string output;   ///< The file that it describes, which lies beside it.
  std::string format;   ///< And what it is.
  std::string hash;     ///< Of that file.
  double fps = 0.0;     ///< Of its motion; 0: not recorded.
  Run run;
  bool mirror = false;          ///< RunRequest::mirror.
  std::vector<ReadFile> files;  ///< Their paths are not known.
};

/// Reads a sidecar. Errors (kInput): it is none, or a run cannot have these options.
/// @param file  for messages.
[[nodiscard]] Result<Sidecar> read_sidecar(std::string_view text, const std::string& file);

}  // namespace retarget
