#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/options.h"

namespace RETARGET_API retarget {

/// Returns an error (kInput) if the path is a folder; its hint names the command that takes
/// folders.
[[nodiscard]] Result<void> check_no_folder(const std::string& path);

/// Checks options that need no clip: contradictions are kUsage errors, unreadable files kConfig
/// errors.
[[nodiscard]] Result<void> check_human_options(const HumanOptions& options);

/// Rejects contradictory options of method and time (kUsage).
[[nodiscard]] Result<void> check_solving_options(const Options& options);

/// Rejects a frame rate without effect (kUsage): all formats of a fit have their own rate.
[[nodiscard]] Result<void> check_rate(const Options& options);

/// Requires one robot, by name or by model, and a retargeting configuration with a model (kUsage).
[[nodiscard]] Result<void> check_robot_choice(const RobotChoice& robot);
[[nodiscard]] Result<void> check_config_choice(const RobotChoice& robot,
                                               const SolveOptions& options);

/// Returns the options of a fit: `fit`, overridden by the options file, the window, excluded terms
/// and the number of written digits. Errors: the file (kConfig), unknown terms (kUsage).
[[nodiscard]] Result<FitOptions> choose_fit(const Options& options, FitOptions fit);

/// Configuration files for retargeting to one robot.
struct ConfigFiles {
  std::string of_lafan1;  ///< File for LAFAN1-like clips, and for all clips if of_others is empty.
  std::string of_others;  ///< File for all other clips; empty: of_lafan1 is used.
};

/// Returns whether SolveOptions::ik_config is `published` or `derived` instead of a file.
[[nodiscard]] bool is_config_kind(const std::string& ik_config);

/// Returns the configurations that the options choose for a robot.
///
/// A robot may have two: `lafan1_to_NAME.json` in configs/, of the published method, and `ik.json`
/// in its folder, derived from its model. By default the derived one is used. The published method
/// is the exception: with LAFAN1 and the robots of the data folder it uses the published one,
/// because its results are compared with published ones. kConfig error: no configuration exists.
/// @param ik_config  `published`, `derived`, a file, or empty.
/// @param robot      name of the robot.
[[nodiscard]] Result<ConfigFiles> find_configs(const std::string& ik_config, Method method,
                                               const std::filesystem::path& robot_folder,
                                               const std::filesystem::path& data_folder,
                                               const std::string& robot);

/// Returns the recorded name of a file. Files in the data folder get relative names, so that an
/// installed tool and a source tree record the same.
[[nodiscard]] std::string recorded_name(const std::filesystem::path& path,
                                        const std::filesystem::path& data_folder);

/// Returns the memory limit in bytes: the user's (SourceOptions::memory_gb), else three quarters of
/// the available memory. 0: unknown.
[[nodiscard]] std::uint64_t memory_bound(double memory_gb);

/// Returns the share of the limit that a motion's file, a clip or an array may take; unlimited if
/// the limit is unknown.
[[nodiscard]] std::size_t memory_share(double memory_gb);

/// Size of a planned motion and of its source.
struct MotionNeed {
  std::int64_t frames = 0;
  FrameRate rate;
  std::uint64_t file_bytes = 0;  ///< Size of the source file.
  std::string file;              ///< Name of the source file, for messages.
  bool is_solved = true;  ///< True: retargeted from a human and measured; false: read from a file.
};

/// Checks that the motion and its output files fit into memory: within the user's limit, and in
/// proportion to the size of the source file.
/// @return kInput error with the required size and the option that reduces it.
[[nodiscard]] Result<void> check_need(const MotionNeed& need, double memory_gb,
                                      const SaveOptions& save);

}  // namespace retarget
