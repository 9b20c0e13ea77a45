#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "console.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/plan.h"

namespace retarget::cli {

/// Functions that several commands apply to their arguments.

/// Returns the folder that holds robots/ and configs/.
[[nodiscard]] Result<std::string> data_folder_of(const CommonArguments& common);

/// Moves --smpl into the run's motion. Errors (kUsage): --bvh is given as well.
[[nodiscard]] Result<void> take_smpl_file(RunArguments& arguments);

/// Returns all files that a run is known to read in advance, which must not be overwritten.
[[nodiscard]] std::vector<std::string> files_read(const Run& run, const CommonArguments& common);

/// Parses an optional --fps; nothing: the source's rate. Errors (kUsage): an invalid rate.
[[nodiscard]] Result<std::optional<double>> rate_of(const std::string& fps);

/// Loads the robot of a run and prints what was found for it.
[[nodiscard]] Result<LoadedRobot> load_robot(const RobotChoice& choice,
                                             const CommonArguments& common, Console& console,
                                             Soles soles = Soles::kFound);

/// The same, with limits, configurations and the fit's options.
[[nodiscard]] Result<RobotSetup> set_up_robot(const Run& run, const CommonArguments& common,
                                              Console& console);

/// Returns true if a file name ends in .glb, ignoring case.
[[nodiscard]] bool is_glb_name(const std::string& path);

}  // namespace retarget::cli
