// `retarget compare`: whether two motions agree.

#include <array>

#include "base/file.h"
#include "base/try.h"
#include "commands.h"
#include "io/compare_motions.h"
#include "motion/clip_size.h"
#include "read_source.h"
#include "robot_motion_options.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

// without a robot the files are compared as they are, and nothing is read into them
Result<void> check_no_reading(const ReadingOptions& options) {
  const bool given = !options.from.empty() || options.source_fps > 0.0 ||
                     !options.quaternion.empty() || !options.angles.empty() ||
                     !options.unit.empty() || !options.dof.empty() || !options.motion.empty() ||
                     options.ignore_header;
  if (!given) return {};
  return usage_failure(
      "how the files are to be read is said, and without a robot they are "
      "compared as they are",
      "add --robot NAME");
}

using MotionTables = std::array<MotionTable, 2>;

Result<MotionTables> load_as_they_are(const CompareOptions& options) {
  TRY(check_no_reading(options.reading));
  MotionTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string& file = i == 0 ? options.a : options.b;
    TRY_ASSIGN(const auto content, read_file(file, ErrorKind::kInput,
                                             memory_share(options.run.source), kLargeFileHint));
    TRY_ASSIGN(tables[i], parse_motion_table(content.view(), file));
  }
  return tables;
}

Result<MotionTables> load_of_robot(const CompareOptions& options, Console& console) {
  TRY(check_robot_choice(options.run));
  TRY_ASSIGN(const auto data_folder, data_folder_of(options.run.common));
  TRY_ASSIGN(const auto chosen, load_chosen_robot(options.run, data_folder, console));
  TRY_ASSIGN(const auto read_options, read_motion_options(options.reading, options.run.source));
  MotionTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string& file = i == 0 ? options.a : options.b;
    TRY_ASSIGN(const auto motion, load_robot_motion(file, chosen.robot, read_options));
    print_motion(file, motion, console);
    tables[i] = motion_table(motion.clip);
    if (motion.rate_known) tables[i].others = {{"fps", {motion.clip.rate().fps()}}};
  }
  // a rate is held against a rate
  if (tables[0].others.empty() || tables[1].others.empty()) {
    tables[0].others = tables[1].others = {};
  }
  return tables;
}

Result<void> compare_checked(const CompareOptions& options, Console& console) {
  if (options.a == "-" && options.b == "-") {
    return usage_failure("standard input can be read once only");
  }
  const bool has_robot = !options.run.robot.empty() || !options.run.robot_xml.empty();
  TRY_ASSIGN(const auto tables,
             has_robot ? load_of_robot(options, console) : load_as_they_are(options));
  TRY_ASSIGN(const auto found, compare_motions(tables[0], tables[1], options.tolerance));
  const char* label = "compared";
  for (const std::string& line : difference_lines(found)) {
    console.line(label, line);
    label = "";
  }
  return check_agreement(found, options.tolerance, options.a, options.b);
}

}  // namespace

ExitCode compare(const CompareOptions& options, Console& console) {
  const auto done = compare_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
