// The default command: one motion file to a robot's motion files.

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "base/file.h"
#include "clip_run.h"
#include "commands.h"
#include "outputs.h"
#include "read_source.h"
#include "robot/find_robot.h"
#include "run_setup.h"
#include "usage_errors.h"
#include "written_files.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& path) {
  std::error_code ignored;
  return path == "-" || fs::is_regular_file(path, ignored);
}

bool is_model(const std::string& path) {
  const fs::path ending = fs::path(path).extension();
  return ending == ".xml" || ending == ".urdf";
}

// a robot's name or folder
bool names_robot(const RunOptions& options, const std::string& word) {
  if (is_file(word)) return false;
  const auto data_folder = data_folder_of(options.common);
  return data_folder && find_robot(word, *data_folder / "robots");
}

Failure one_too_many(const std::string& what, const std::string& one, const std::string& other) {
  return usage_failure("two " + what + " are given: " + one + " and " + other,
                       "retarget batch takes many motions and robots");
}

// what is named without an option, in either order
Result<void> take_words(RunOptions& options) {
  std::string motion = options.source.file + options.smpl_file;
  std::string robot = options.robot + options.robot_xml;
  for (const std::string& word : options.words) {
    if (word.empty()) continue;
    if (motion.empty() && !names_robot(options, word)) {
      motion = options.source.file = word;
    } else if (is_file(word) && !is_model(word)) {
      std::error_code ignored;
      if (motion == options.words[0] && motion != "-" && !fs::exists(motion, ignored)) {
        return usage_failure(
            "\"" + motion + "\" is no command, no motion file and no robot",
            "retarget --help lists the commands, retarget robots list lists the robots");
      }
      return one_too_many("motions", motion, word);
    } else if (robot.empty()) {
      robot = options.robot = word;
    } else {
      return one_too_many("robots", robot, word);
    }
  }
  return {};
}

Result<void> check_all_given(const RunOptions& options) {
  std::vector<Need> needs;
  if (options.source.file.empty()) needs.push_back({"motion file", "MOTION or --bvh FILE"});
  if (options.robot.empty() && options.robot_xml.empty()) {
    needs.push_back({"robot", "ROBOT, --robot NAME or --robot-xml FILE"});
  }
  if (options.output.empty()) needs.push_back({"output", "-o FILE, or -o - for standard output"});
  if (!needs.empty() && !options.robot_xml.empty() && options.ik_config.empty()) {
    needs.push_back({"mapping", "--ik-config FILE"});
  }
  return check_needs(needs, "as in retarget walk.bvh g1 -o walk.csv");
}

Result<void> check_usage(const RunOptions& options) {
  if (auto folder = check_no_folder(options.source.file); !folder) return folder;
  if (auto given = check_all_given(options); !given) return given;
  if (auto solving = check_solving_options(options); !solving) return solving;
  if (options.report == "-") {
    return usage_failure("--report needs a file", "retarget evaluate --json - prints a report");
  }
  if (!options.report.empty()) {
    if (auto folder = check_output_folder(options.report); !folder) return folder;
  }
  return check_outputs(options, files_of(options), {options.report, options.human.write_map});
}

Result<void> run_checked(RunOptions options, Console& console) {
  if (auto taken = take_words(options); !taken) return taken;
  if (auto chosen = choose_motion_file(options); !chosen) return chosen;
  if (auto usage = check_usage(options); !usage) return usage;
  const auto data_folder = data_folder_of(options.common);
  if (!data_folder) return failure(data_folder.error());
  if (auto robot = resolve_robot(options.robot, *data_folder); !robot) return robot;
  const auto setup = load_robot_setup(options, *data_folder, console);
  if (!setup) return failure(setup.error());
  const auto outcome = run_clip(options, *setup, *data_folder, console);
  if (!outcome) return failure(outcome.error());
  return {};
}

}  // namespace

ExitCode run(const RunOptions& options, Console& console) {
  const auto done = run_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
