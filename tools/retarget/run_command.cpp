// The default command: one motion file to a robot's motion files.

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "arguments.h"
#include "base/file.h"
#include "base/try.h"
#include "commands.h"
#include "console.h"
#include "plan/check_options.h"
#include "plan/gates.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "robot/find_robot.h"
#include "run/run_lines.h"
#include "run/run_to_files.h"
#include "run/written_files.h"
#include "shared_arguments.h"
#include "usage_errors.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

bool is_given_file(const std::string& path) {
  return path == "-" || is_file(path);
}

bool is_model(const std::string& path) {
  const fs::path ending = fs::path(path).extension();
  return ending == ".xml" || ending == ".urdf";
}

// a robot's name or folder
bool names_robot(const RunArguments& arguments, const std::string& word) {
  if (is_given_file(word)) return false;
  const auto data_folder = data_folder_of(arguments.common);
  return data_folder && find_robot(word, fs::path(*data_folder) / "robots");
}

Failure one_too_many(const std::string& what, const std::string& one, const std::string& other) {
  return usage_failure("two " + what + " are given: " + one + " and " + other,
                       "retarget batch takes many motions and robots");
}

// what is named without an option, in either order
Result<void> take_words(RunArguments& arguments) {
  RobotChoice& choice = arguments.run.robot;
  std::string motion = arguments.run.motion + arguments.smpl_file;
  std::string robot = choice.name + choice.model;
  for (const std::string& word : arguments.words) {
    if (word.empty()) continue;
    if (motion.empty() && !names_robot(arguments, word)) {
      motion = arguments.run.motion = word;
    } else if (is_given_file(word) && !is_model(word)) {
      std::error_code ignored;
      if (motion == arguments.words[0] && motion != "-" && !fs::exists(motion, ignored)) {
        return usage_failure(
            "\"" + motion + "\" is not a command, a motion file or a robot",
            "retarget --help lists the commands, retarget robots list lists the robots");
      }
      return one_too_many("motions", motion, word);
    } else if (robot.empty()) {
      robot = choice.name = word;
    } else {
      return one_too_many("robots", robot, word);
    }
  }
  return {};
}

Result<void> check_all_given(const Run& run) {
  std::vector<Need> needs;
  if (run.motion.empty()) needs.push_back({"motion file", "MOTION or --bvh FILE"});
  if (run.robot.name.empty() && run.robot.model.empty()) {
    needs.push_back({"robot", "ROBOT, --robot NAME or --robot-xml FILE"});
  }
  if (run.output.empty()) needs.push_back({"output", "-o FILE, or -o - for standard output"});
  if (!needs.empty() && !run.robot.model.empty() && run.options.solve.ik_config.empty()) {
    needs.push_back({"retargeting configuration", "--ik-config FILE"});
  }
  return check_needs(needs, "as in retarget walk.bvh g1 -o walk.csv");
}

Result<void> check_usage(const RunArguments& arguments, const std::string& data_folder) {
  const Run& run = arguments.run;
  const RunRequest& request = arguments.request;
  // some motions of robots are folders
  if (run.options.source.from_robot.empty()) TRY(check_no_folder(run.motion));
  TRY(check_all_given(run));
  TRY(check_robot_choice(run.robot));
  TRY(check_config_choice(run.robot, run.options.solve));
  TRY(check_solving_options(run.options));
  if (request.report == "-") {
    return usage_failure("--report needs a file", "retarget evaluate --json - prints a report");
  }
  if (request.html == "-") {
    return usage_failure("--html needs a file", "name one that ends in .html");
  }
  if (request.png == "-") return usage_failure("--png needs a file");
  if (request.strip > 0 && request.png.empty()) {
    return usage_failure("--strip is for a picture, and none is written", "add --png FILE");
  }
  for (const std::string& file : {request.report, request.html, request.png}) {
    if (!file.empty()) TRY(check_output_folder(file));
  }
  std::vector<std::string> read = files_of(run, data_folder);
  read.insert(read.end(), arguments.gates.begin(), arguments.gates.end());
  return check_outputs(run, request.sidecar, read,
                       {request.report, request.html, request.png, request.write_map});
}

}  // namespace

Result<ExitCode> run(const RunArguments& given, Console& console) {
  RunArguments arguments = given;
  TRY(take_words(arguments));
  TRY(take_smpl_file(arguments));
  const auto data_folder = data_folder_of(arguments.common);
  TRY(check_usage(arguments, data_folder.value_or(std::string())));
  if (!data_folder) return failure(data_folder.error());
  TRY_ASSIGN(const RobotSetup setup, set_up_robot(arguments.run, arguments.common, console));
  // sidecars have the whole name
  if (!arguments.run.robot.name.empty()) arguments.run.robot.name = setup.loaded.name;
  RunRequest request = arguments.request;
  // quality decides only where gates were asked for
  if (!arguments.gates.empty()) {
    TRY_ASSIGN(request.gates, changed_gates(arguments.gates, *data_folder));
  }
  TRY_ASSIGN(const RunOutcome outcome, run_to_files(arguments.run, request, setup, console));
  if (!request.gates || outcome.quality->passed()) return kDone;
  return run_failure(arguments.run.output == "-" ? "standard output" : arguments.run.output,
                     "the motion misses a gate: " + missed_gates_text(*outcome.quality),
                     "it is written all the same");
}

}  // namespace retarget::cli
