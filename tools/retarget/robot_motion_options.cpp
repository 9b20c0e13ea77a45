#include "robot_motion_options.h"

#include "base/try.h"
#include "outputs.h"
#include "read_source.h"

namespace retarget::cli {

Result<ReadMotionOptions> read_motion_options(const ReadingOptions& options,
                                              const SourceOptions& source) {
  ReadMotionOptions read;
  read.most_bytes = memory_share(source);
  if (!options.from.empty()) {
    TRY_ASSIGN(read.format, format_from_name(options.from));
  }
  if (options.source_fps > 0.0) read.rate = frame_rate_from_fps(options.source_fps);
  if (options.quaternion == "xyzw") read.quaternion = QuaternionOrder::kXyzw;
  if (options.quaternion == "wxyz") read.quaternion = QuaternionOrder::kWxyz;
  if (!options.angles.empty()) read.degrees = options.angles == "deg";
  if (options.unit == "m") read.metres_per_unit = 1.0;
  if (options.unit == "cm") read.metres_per_unit = 0.01;
  if (options.unit == "mm") read.metres_per_unit = 0.001;
  read.variant = options.dof;
  read.motion = options.motion;
  read.ignore_header = options.ignore_header;
  return read;
}

void print_motion(const std::string& file, const RobotMotion& motion, Console& console,
                  const std::string& rate_option) {
  console.line("read",
               (file == "-" ? "standard input" : file) + ": " +
                   std::string(format_name(motion.format)) + ", " +
                   count_text(motion.clip.frame_count(), "frame") + " at " +
                   to_text(motion.clip.rate()) + " fps" +
                   (motion.rate_known ? "" : ", which the file does not say: " + rate_option));
  for (const std::string& note : motion.notes) console.line("", note);
  for (const std::string& warning : motion.warnings) console.warn({{0, 0, warning}}, file);
}

void warn_of_losses(const OutputOptions& options, const RobotClip& motion, Console& console) {
  const auto items = plan_outputs(options);
  if (!items) return;
  for (const OutputItem& item : *items) {
    for (const std::string& loss : format_losses(motion, item.format)) {
      console.warn({{0, 0, loss}}, item.path);
    }
  }
}

}  // namespace retarget::cli
