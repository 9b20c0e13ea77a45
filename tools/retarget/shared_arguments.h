#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "console.h"
#include "retarget/error.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "retarget/plan.h"

namespace retarget::cli {

/// What several commands do with their arguments.

/// The folder that holds robots/ and configs/.
[[nodiscard]] Result<std::string> data_folder_of(const CommonArguments& common);

/// Makes the file of --smpl the motion; --bvh beside it is refused (kUsage).
[[nodiscard]] Result<void> take_smpl_file(RunArguments& arguments);

/// Every file that a run reads, as far as it is known before: what must not be written.
[[nodiscard]] std::vector<std::string> files_read(const Run& run, const CommonArguments& common);

/// What --fps says where it may be left out; nothing: the source's own. kUsage error: no rate.
[[nodiscard]] Result<std::optional<double>> rate_of(const std::string& fps);

/// Loads the robot of a run and says what was found for it.
[[nodiscard]] Result<LoadedRobot> load_robot(const RobotChoice& choice,
                                             const CommonArguments& common, Console& console,
                                             Soles soles = Soles::kFound);

/// The same with limits, configurations and the fit's options.
[[nodiscard]] Result<RobotSetup> set_up_robot(const Run& run, const CommonArguments& common,
                                              Console& console);

}  // namespace retarget::cli
