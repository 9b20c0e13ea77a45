#include "io/reading_table.h"

namespace retarget {
namespace {

constexpr const char* kFoundGroup =
    "Motion files (detected and printed; these options override it)";

Option found_row(const char* name, auto& member, const char* type, const char* help,
                 OptionInfo info = {}) {
  info.decides = false;
  return option(name, member, kFoundGroup, type, help, std::move(info));
}

}  // namespace

OptionTable reading_table(ReadingOptions& options) {
  OptionTable table = {
      found_row("source-fps", options.source_fps, "N",
                "Frames per second of the file (default: the file's own; CSV 30, SOMA 120)",
                {.min = 0.001, .max = 1e6}),
      found_row("from", options.from, "", "NPZ: joint order of the file"),
      found_row("source-quat", options.quaternion, "", "Order of the root quaternion in the file"),
      found_row("source-angles", options.angles, "", "Unit of the joints in a CSV or pickle"),
      found_row("source-unit", options.unit, "", "Unit of the root position in a CSV or pickle"),
      found_row("source-dof", options.dof, "NAME",
                "Variant of the robot whose joints the file has"),
      found_row("motion", options.motion, "NAME", "One of several motions in a PBHC pickle"),
      found_row("ignore-header", options.ignore_header, "",
                "Read the columns of a CSV by position, whatever its header says")};
  table[1].choices = {"npz-mjlab", "npz-beyondmimic"};
  table[3].choices = {"rad", "deg"};
  table[4].choices = {"m", "cm", "mm"};
  return table;
}

ReadMotionOptions read_motion_options(const ReadingOptions& options) {
  ReadMotionOptions read;
  read.format = options.from;
  if (options.source_fps > 0.0) read.rate = frame_rate_from_fps(options.source_fps);
  read.quaternion = options.quaternion;
  if (!options.angles.empty()) read.degrees = options.angles == "deg";
  if (options.unit == "m") read.metres_per_unit = 1.0;
  if (options.unit == "cm") read.metres_per_unit = 0.01;
  if (options.unit == "mm") read.metres_per_unit = 0.001;
  read.variant = options.dof;
  read.motion = options.motion;
  read.ignore_header = options.ignore_header;
  return read;
}

}  // namespace retarget
