#include "read_motion.h"

#include "retarget/check_options.h"
#include "retarget/text.h"

namespace retarget::cli {

ReadMotionOptions read_motion_options(const ReadingOptions& options, double memory_gb) {
  ReadMotionOptions read = retarget::read_motion_options(options);
  read.max_bytes = memory_share(memory_gb);
  return read;
}

void print_motion(const std::string& file, const RobotMotion& motion, Console& console,
                  const std::string& rate_option) {
  console.line("read", (file == "-" ? "standard input" : file) + ": " +
                           std::string(format_name(motion.format)) + ", " +
                           count_text(motion.clip.frame_count(), "frame") + " at " +
                           to_text(motion.clip.rate()) + " fps" +
                           (motion.rate_known ? "" : ", not given in the file: " + rate_option));
  for (const std::string& note : motion.notes) console.line("", note);
  for (const std::string& warning : motion.warnings) console.warn({{0, 0, warning}}, file);
}

void warn_of_losses(const RobotClip& motion, std::span<const WrittenFile> files, Console& console) {
  for (const WrittenFile& file : files) {
    for (const std::string& loss : format_losses(motion, file.item.format)) {
      console.warn({{0, 0, loss}}, file.item.path);
    }
  }
}

}  // namespace retarget::cli
