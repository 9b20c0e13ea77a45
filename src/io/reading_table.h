#pragma once

#include <optional>
#include <string>

#include "options/option_table.h"
#include "retarget/motion_io.h"

namespace retarget {

/// What a file of a robot's motion does not say; nothing: found. ReadMotionOptions as options.
struct ReadingOptions {
  std::optional<MotionFormat> from;  ///< Format in place of what the content says.
  double source_fps = 0.0;           ///< 0: as the file says.
  std::optional<QuaternionOrder> quaternion;
  std::string angles;  ///< `rad`, `deg`.
  std::string unit;    ///< `m`, `cm`, `mm`.
  std::string dof;     ///< Variant of the robot that the columns are of.
  std::string motion;  ///< One of several in a PBHC file.
  bool ignore_header = false;
};

[[nodiscard]] OptionTable reading_table(ReadingOptions& options);

/// What they mean for the reader.
[[nodiscard]] ReadMotionOptions read_motion_options(const ReadingOptions& options);

}  // namespace retarget
