#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// Name of the requested reference file next to an output; empty: none.
/// Errors (kUsage): an extension other than .npz and .csv; no name if the motion goes to standard
/// output.
[[nodiscard]] Result<std::string> reference_path(const std::string& output,
                                                 const SaveOptions& options);

/// A reference that is written but not committed yet.
struct ReferenceFile {
  OutputFile file;
  std::vector<SummaryLine> lines;  ///< Samples, corrections, and what remains beyond limits.
};

/// Makes the reference of a motion (make_reference) and writes it.
/// @param path    from reference_path(), not empty.
/// @param clip    as in its file.
/// @param write   its contacts and scene.
/// @param limits  joint ranges; null: the robot's default set.
[[nodiscard]] Result<ReferenceFile> write_reference(const std::string& path, const RobotClip& clip,
                                                    const WriteMotionOptions& write,
                                                    const SaveOptions& options,
                                                    const LimitSet* limits);

}  // namespace retarget
