#pragma once

#include "retarget/option_table.h"
#include "retarget/options.h"

namespace retarget::python {

/// Options of convert.
struct ConvertOptions {
  ReadingOptions reading;
  RobotChoice robot;
  TimeOptions time;
  SaveOptions save;
  double memory_gb = 0.0;
};

/// Returns the options of convert except the robot's name and the files.
[[nodiscard]] OptionTable convert_keywords(ConvertOptions& options);

}  // namespace retarget::python
