// `retarget compare`: whether two motions agree.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/file.h"
#include "commands.h"
#include "io/compare_motions.h"
#include "read_source.h"
#include "retarget/motion_io.h"
#include "robot_motion_options.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

constexpr std::size_t kColumnsShown = 5;

// enough digits for any difference, however small
std::string difference_text(double value) {
  constexpr int kDigits = 3;
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                          std::chars_format::general, kDigits);
  return std::string(digits.data(), end);
}

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

// of the robot where one is given, else as the files have their columns
Result<std::array<MotionTable, 2>> load_tables(const CompareOptions& options, Console& console) {
  std::array<MotionTable, 2> tables;
  const bool has_robot = !options.run.robot.empty() || !options.run.robot_xml.empty();
  std::shared_ptr<const Robot> robot;
  if (has_robot) {
    if (auto sound = check_robot_choice(options.run); !sound) return failure(sound.error());
    const auto data_folder = data_folder_of(options.run.common);
    if (!data_folder) return failure(data_folder.error());
    const auto chosen = load_chosen_robot(options.run, *data_folder, console);
    if (!chosen) return failure(chosen.error());
    robot = chosen->robot;
  }
  if (!has_robot) {
    if (auto sound = check_no_reading(options.reading); !sound) return failure(sound.error());
  }
  const auto read_options = read_motion_options(options.reading, options.run.source);
  if (!read_options) return failure(read_options.error());
  const std::array<std::string, 2> files = {options.a, options.b};
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (robot) {
      const auto motion = read_motion(files[i], robot, *read_options);
      if (!motion) return failure(motion.error());
      print_motion(files[i], *motion, console);
      tables[i] = motion_table(motion->clip);
      if (motion->rate_known) tables[i].others = {{"fps", {motion->clip.rate().fps()}}};
      continue;
    }
    auto content = read_file(files[i], ErrorKind::kInput, memory_share(options.run.source));
    if (!content) {
      add_memory_hint(content.error());
      return failure(content.error());
    }
    auto table = parse_motion_table(content->view(), files[i]);
    if (!table) return failure(table.error());
    tables[i] = std::move(*table);
  }
  // a rate is held against a rate
  if (tables[0].others.empty() || tables[1].others.empty()) {
    if (has_robot) tables[0].others = tables[1].others = {};
  }
  return tables;
}

Result<void> compare_checked(const CompareOptions& options, Console& console) {
  if (options.a == "-" && options.b == "-") {
    return usage_failure("standard input can be read once only");
  }
  const auto tables = load_tables(options, console);
  if (!tables) return failure(tables.error());
  const auto found = compare_motions((*tables)[0], (*tables)[1], options.tolerance);
  if (!found) return failure(found.error());
  const auto frames = std::min(found->frames_a, found->frames_b);
  console.line("compared",
               count_text(static_cast<long>(frames), "frame") + " of " +
                   count_text(static_cast<long>((*tables)[0].columns.size()), "column") +
                   ", largest difference " + difference_text(found->largest));
  for (std::size_t i = 0; i < std::min(found->columns.size(), kColumnsShown); ++i) {
    const ColumnDifference& column = found->columns[i];
    console.line("", column.column + ": " + difference_text(column.largest) + " in frame " +
                         std::to_string(column.largest_frame) + ", beyond the tolerance in " +
                         count_text(static_cast<long>(column.frames_beyond), "frame") +
                         ", first in " + std::to_string(column.first_frame));
  }
  if (found->agree()) return {};
  if (found->frames_a != found->frames_b) {
    return run_failure("", options.a + " has " +
                               count_text(static_cast<long>(found->frames_a), "frame") + ", " +
                               options.b + " " + std::to_string(found->frames_b));
  }
  const ColumnDifference& worst = found->columns.front();
  return run_failure("", "the motions differ in " +
                             count_text(static_cast<long>(found->columns.size()), "column") +
                             " by more than " + difference_text(options.tolerance) + ", most in " +
                             worst.column + ": " + difference_text(worst.largest) + " in frame " +
                             std::to_string(worst.largest_frame));
}

}  // namespace

ExitCode compare(const CompareOptions& options, Console& console) {
  const auto done = compare_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
