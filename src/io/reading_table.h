#pragma once

#include <string>

#include "options/option_table.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"

namespace retarget {

/// How the commands that read robots' motions are told what a file does not say.
struct ReadingOptions : MotionFileOptions {
  double source_fps = 0.0;  ///< 0: as the file says.
  std::string motion;       ///< One of several in a PBHC file.
};

[[nodiscard]] OptionTable reading_table(ReadingOptions& options);

/// What they mean for the reader.
[[nodiscard]] ReadMotionOptions read_motion_options(const ReadingOptions& options);
/// @param source_fps  0: as the file says.
/// @param motion      one of several in a PBHC file.
[[nodiscard]] ReadMotionOptions read_motion_options(const MotionFileOptions& options,
                                                    double source_fps, const std::string& motion);

}  // namespace retarget
