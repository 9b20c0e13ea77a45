#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/options.h"

namespace retarget {

/// Error (kInput): the path is a folder; the hint names the command that takes folders.
[[nodiscard]] Result<void> check_no_folder(const std::string& path);

/// What can be told of the options without a clip: contradictions are kUsage errors, files that
/// cannot be read kConfig.
[[nodiscard]] Result<void> check_human_options(const HumanOptions& options);

/// Options of method and time that contradict each other (kUsage).
[[nodiscard]] Result<void> check_solving_options(const Options& options);

/// One robot, by its name or its model, and a model with a retargeting configuration (kUsage).
[[nodiscard]] Result<void> check_robot_choice(const RobotChoice& robot);
[[nodiscard]] Result<void> check_config_choice(const RobotChoice& robot,
                                               const SolveOptions& options);

/// The options of a fit: `fit`, over it the options' file, the window, terms that are left out, and
/// as many digits as are written. Errors: of the file (kConfig), unknown terms (kUsage).
[[nodiscard]] Result<FitOptions> choose_fit(const Options& options, FitOptions fit);

}  // namespace retarget
