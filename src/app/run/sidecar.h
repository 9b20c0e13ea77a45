#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/run/outputs.h"
#include "retarget/data_folder.h"
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
  std::string file;  ///< File name given by the user; inside the data folder: relative to it.
  std::string path;  ///< Path used to open it.
  std::string hash;  ///< `sha256:...`; empty if it cannot be hashed (standard input, a pipe).
};

/// All files that determine the result of a run, with hashes.
/// @param config  file of the retargeting configuration used.
[[nodiscard]] Result<std::vector<ReadFile>> files_read(const Run& run, const LoadedRobot& robot,
                                                       const std::string& config);

/// The files of object tracks with their roles; options name them as FILE or BODY=FILE.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> object_track_files(
    const SolveOptions& options);

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
  std::string limits;                   ///< Name of the limit set; empty: not recorded.
  bool has_dynamics = false;            ///< Whether the report has the metrics of add_dynamics().
  std::vector<ReadFile> files;          ///< Their paths are unknown.
};

/// Parses a sidecar. Errors (kInput): the text is not a sidecar, or its options are invalid.
/// @param file  name for messages.
[[nodiscard]] Result<Sidecar> read_sidecar(std::string_view text, const std::string& file);

/// The report of the motion in a sidecar; an empty object if the sidecar is damaged.
[[nodiscard]] nlohmann::ordered_json report_in(const nlohmann::ordered_json& sidecar);

/// Names the facts and metrics that a sidecar states differently from a repetition of its run, such
/// as `found.fps`. Numbers may differ in the last digits, which depend on the processor. Empty if
/// another build of the tool wrote the sidecar, whose metrics may differ.
/// @param recorded, repeated  texts of sidecars.
[[nodiscard]] std::optional<std::vector<std::string>> altered_members(std::string_view recorded,
                                                                      std::string_view repeated);

/// Changes the name of a recorded file to that of one next to the record, below its recorded name
/// or with its file name, if it no longer exists at its recorded path.
void find_moved(std::string& file, const std::filesystem::path& beside);

/// The same for a recorded robot, which may be a name or a folder. As in a run, the name of a known
/// robot comes before a folder of that name.
void find_moved_robot(std::string& robot, const std::filesystem::path& beside,
                      const DataFolder& data_folder);

}  // namespace retarget
