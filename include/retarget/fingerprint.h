#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/run.h"

// Link retarget::batch.
namespace RETARGET_API retarget {

/// Identifies all inputs other than the clip that determine the result for one robot.
struct RunFingerprint {
  std::string hash;         ///< Changes when any input changes.
  std::string description;  ///< A JSON object: tool, options, files with their hashes, robot.
};

/// The fingerprint includes option values (an explicit default changes nothing), file contents
/// (configuration, limits, fit options, profiles, ...), the robot's compiled model and profile, and
/// the version of the tool.
/// @param run      its motion, robot and output are ignored.
/// @param request  included: whether sidecars are written and whether motions are measured.
[[nodiscard]] Result<RunFingerprint> run_fingerprint(const Run& run, const RunRequest& request,
                                                     const RobotSetup& setup);

/// Returns the present path of a recorded file; empty if it is missing or its content has changed.
using FindRecorded = std::function<std::string(const std::string& path, const std::string& hash)>;

/// Restores the options with which a recorded run read and interpreted its sources and measured its
/// motions: the options that OptionUse::kShowBatch marks.
/// @param description  RunFingerprint::description, parsed.
/// @return the recorded path of the first option file that `find` does not find; empty: none. Such
///   an option is not set.
[[nodiscard]] std::string restore_options(const nlohmann::ordered_json& description,
                                          const FindRecorded& find, Run& run);

/// Returns the options for reading a CSV of a recorded run; other formats are self-describing.
[[nodiscard]] ReadingOptions restored_dialect(const nlohmann::ordered_json& description);

/// Gates by metric, in the form used in RunFingerprint::description.
[[nodiscard]] nlohmann::ordered_json gates_json(const Gates& gates);

/// Hashes the names and contents of a folder's files.
/// @param ending  extension of the files to include, such as `.json`; empty: all.
[[nodiscard]] Result<std::string> folder_hash(const std::filesystem::path& folder,
                                              std::string_view ending);

/// Hashes a motion: a file together with its companion_files(), or a folder.
[[nodiscard]] Result<std::string> motion_hash(const std::string& path);

}  // namespace retarget
