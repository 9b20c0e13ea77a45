#pragma once

#include <optional>
#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"
#include "retarget/options.h"
#include "retarget/solve.h"

namespace RETARGET_API retarget {

/// Writes a motion: in the format that the file's ending or the options name, in several formats to
/// files named after it. Each file appears whole or not at all.
/// Errors: of kUsage, an ending that says no format or another one; of kRun, what cannot be written.
/// @param output  `-` writes standard output.
/// @param options  without, those that the motion's plan was made with.
[[nodiscard]] Result<void> save(const Motion& motion, const std::string& output,
                                const std::optional<SaveOptions>& options = std::nullopt);
[[nodiscard]] Result<void> save(const RobotClip& clip, const std::string& output,
                                const SaveOptions& options = {});

}  // namespace retarget
