#include "retarget/option_table.h"

namespace retarget {

OptionTable reading_table(ReadingOptions& options) {
  OptionTable table = {option("source-fps", options.source_fps, kMotionFileGroup, "N",
                              "Frames per second of the file (default: the file's own; CSV 30, "
                              "SOMA 120)",
                              {.min = 0.001, .max = 1e6, .decides = false})};
  append(table, motion_file_table(options, false));
  // Insert before the last option, which concerns columns.
  table.insert(table.end() - 1,
               option("motion", options.motion, kMotionFileGroup, "NAME",
                      "One of several motions in a PBHC pickle", {.decides = false}));
  return table;
}

ReadMotionOptions read_motion_options(const MotionFileOptions& options, double source_fps,
                                      const std::string& motion) {
  ReadMotionOptions read;
  read.format = options.from;
  if (source_fps > 0.0) read.rate = frame_rate_from_fps(source_fps);
  read.quaternion = options.quaternion;
  if (!options.angles.empty()) read.degrees = options.angles == "deg";
  if (options.unit == "m") read.metres_per_unit = 1.0;
  if (options.unit == "cm") read.metres_per_unit = 0.01;
  if (options.unit == "mm") read.metres_per_unit = 0.001;
  read.variant = options.dof;
  read.motion = motion;
  read.ignore_header = options.ignore_header;
  return read;
}

ReadMotionOptions read_motion_options(const ReadingOptions& options, std::size_t max_bytes) {
  ReadMotionOptions read = read_motion_options(options, options.source_fps, options.motion);
  read.max_bytes = max_bytes;
  return read;
}

}  // namespace retarget
