#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/run/outputs.h"
#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/report.h"
#include "retarget/solve.h"
#include "retarget/time_scale.h"

namespace retarget {

/// A file that a run reads.
struct ReadFile {
  std::string role;  ///< `motion`, `model`, `profile`, `mapping`, or the name of its option.
  std::string file;  ///< As given by the user; inside the data folder: relative to it.
  std::string path;  ///< Path used to open it.
  std::string hash;  ///< `sha256:...`; empty if it cannot be hashed (standard input, a pipe).
};

/// All files that determine the result of a run, with hashes.
/// @param config  file of the retargeting configuration used.
[[nodiscard]] Result<std::vector<ReadFile>> files_read(const Run& run, const LoadedRobot& robot,
                                                       const std::string& config);

/// Formats the sidecar of one output; docs/formats.md describes its members.
/// @param mirror  RunRequest::mirror.
[[nodiscard]] std::string sidecar_text(const Run& run, const Motion& motion,
                                       const WrittenFile& output, const QualityReport& report,
                                       const std::vector<ReadFile>& files, bool mirror = false);

/// The content of a sidecar.
struct Sidecar {
  std::string version;  ///< Version of the tool.
  std::string output;   ///< The file that it describes, in the same folder.
  std::string format;   ///< Format of that file.
  std::string hash;     ///< Hash of that file.
  std::string robot;    ///< Name of the robot; empty: a model without a profile.
  double fps = 0.0;     ///< Frame rate of its motion; 0: not recorded.
  Run run;
  bool mirror = false;                  ///< RunRequest::mirror.
  std::optional<TimeScale> time_scale;  ///< Plan::time_scale.
  std::vector<ReadFile> files;          ///< Their paths are unknown.
};

/// Parses a sidecar. Errors (kInput): the text is not a sidecar, or its options are invalid.
/// @param file  name for messages.
[[nodiscard]] Result<Sidecar> read_sidecar(std::string_view text, const std::string& file);

/// Changes the name of a recorded file to that of one next to the record, below its recorded name or
/// with its file name, if it no longer exists at its recorded path.
void find_moved(std::string& file, const std::filesystem::path& beside);

}  // namespace retarget
