// `retarget compare`: checks whether two motions agree.

#include <array>
#include <string>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/compare.h"
#include "retarget/load.h"
#include "retarget/run.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

// Without a robot the files are compared as raw tables, so reading options have no meaning.
Result<void> check_no_reading(const ReadingOptions& reading) {
  const bool given = reading.from || reading.source_fps > 0.0 || reading.quaternion ||
                     !reading.angles.empty() || !reading.unit.empty() || !reading.dof.empty() ||
                     !reading.motion.empty() || reading.ignore_header;
  if (!given) return {};
  return usage_failure(
      "options for reading the files need a robot; without a robot, files are compared "
      "unchanged",
      "add --robot NAME");
}

using MotionTables = std::array<MotionTable, 2>;

Result<MotionTables> load_as_they_are(const CompareArguments& arguments) {
  RETARGET_TRY(check_no_reading(arguments.reading));
  MotionTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string& file = i == 0 ? arguments.a : arguments.b;
    RETARGET_TRY_ASSIGN(tables[i], load_motion_table(file, memory_share(arguments.memory_gb)));
  }
  return tables;
}

Result<MotionTables> load_of_robot(const CompareArguments& arguments, Console& console) {
  RETARGET_TRY(check_robot_choice(arguments.robot));
  RETARGET_TRY_ASSIGN(const LoadedRobot chosen,
                      load_robot(arguments.robot, arguments.common, console, Soles::kAsTheyAre));
  const auto read_options =
      read_motion_options(arguments.reading, memory_share(arguments.memory_gb));
  MotionTables tables;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string& file = i == 0 ? arguments.a : arguments.b;
    RETARGET_TRY_ASSIGN(const auto motion, load_recorded_motion(file, chosen.robot, read_options));
    report_reading(file, motion, console);
    tables[i] = motion_table(motion.clip);
    if (motion.rate_known) tables[i].others = {{"fps", {motion.clip.rate().fps()}}};
  }
  // Compare rates only if both files state one.
  if (tables[0].others.empty() || tables[1].others.empty()) {
    tables[0].others = tables[1].others = {};
  }
  return tables;
}

}  // namespace

Result<void> compare(const CompareArguments& arguments, Console& console) {
  if (arguments.a == "-" && arguments.b == "-") {
    return usage_failure("standard input can be read only once");
  }
  const bool has_robot = !arguments.robot.name.empty() || !arguments.robot.model.empty();
  RETARGET_TRY_ASSIGN(const auto tables,
                      has_robot ? load_of_robot(arguments, console) : load_as_they_are(arguments));
  RETARGET_TRY_ASSIGN(const auto found, compare_motions(tables[0], tables[1], arguments.tolerance));
  const char* label = "compared";
  for (const std::string& line : difference_lines(found)) {
    console.line(label, line);
    label = "";
  }
  return check_agreement(found, arguments.tolerance, arguments.a, arguments.b);
}

}  // namespace retarget::cli
