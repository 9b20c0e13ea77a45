// The default command: converts one motion file to a robot's motion files.

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/measure.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/robots.h"
#include "retarget/run.h"
#include "retarget/try.h"
#include "retarget/view.h"
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

// Returns true for a robot's name or folder.
bool is_robot(const RunArguments& arguments, const std::string& word) {
  if (is_given_file(word)) return false;
  const auto data_folder = data_folder_of(arguments.common);
  return data_folder && names_robot(word, robot_folders(*data_folder));
}

Failure one_too_many(const std::string& what, const std::string& one, const std::string& other) {
  return usage_failure("two " + what + " given: " + one + " and " + other,
                       "use retarget batch for several motions or robots");
}

// Assigns positional arguments, which may be in either order.
Result<void> take_words(RunArguments& arguments) {
  RobotChoice& choice = arguments.run.robot;
  std::string motion = arguments.run.motion + arguments.smpl_file;
  std::string robot = choice.name + choice.model;
  for (const std::string& word : arguments.words) {
    if (word.empty()) continue;
    if (motion.empty() && !is_robot(arguments, word)) {
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
  return check_needs(needs, "for example: retarget walk.bvh g1 -o walk.csv");
}

Result<void> check_usage(const RunArguments& arguments, const std::string& data_folder) {
  const Run& run = arguments.run;
  const RunRequest& request = arguments.request;
  // Some robot motion formats are folders.
  if (run.options.source.from_robot.empty()) RETARGET_TRY(check_no_folder(run.motion));
  RETARGET_TRY(check_all_given(run));
  RETARGET_TRY(check_robot_choice(run.robot));
  RETARGET_TRY(check_config_choice(run.robot, run.options.solve));
  RETARGET_TRY(check_solving_options(run.options));
  RETARGET_TRY(check_rate(run.options));
  if (request.report == "-") {
    return usage_failure("--report needs a file",
                         "use retarget evaluate --json - to print a report");
  }
  if (arguments.html == "-") {
    return usage_failure("--html needs a file", "give a file name that ends in .html");
  }
  if (arguments.png == "-") return usage_failure("--png needs a file");
  if (arguments.strip > 0 && arguments.png.empty()) {
    return usage_failure("--strip needs a PNG output", "add --png FILE");
  }
  for (const std::string& file : {request.report, arguments.html, arguments.png}) {
    if (!file.empty()) RETARGET_TRY(check_output_folder(file));
  }
  std::vector<std::string> read = files_of(run, data_folder);
  read.insert(read.end(), arguments.gates.begin(), arguments.gates.end());
  RETARGET_TRY(check_outputs(run, request.sidecar, read,
                             {request.report, arguments.html, arguments.png, request.write_map}));
  RETARGET_TRY(check_output_ending(arguments.png, {".png"}, "a picture in the format PNG"));
  return check_output_ending(arguments.html, {".html", ".htm"}, "a page in HTML");
}

}  // namespace

Result<ExitCode> run(const RunArguments& given, Console& console) {
  RunArguments arguments = given;
  RETARGET_TRY(take_words(arguments));
  RETARGET_TRY(take_smpl_file(arguments));
  const auto data_folder = data_folder_of(arguments.common);
  RETARGET_TRY(check_usage(arguments, data_folder.value_or(std::string())));
  if (!data_folder) return failure(data_folder.error());
  RETARGET_TRY_ASSIGN(const RobotSetup setup,
                      set_up_robot(arguments.run, arguments.common, console));
  // Sidecars record the full name.
  if (!arguments.run.robot.name.empty()) arguments.run.robot.name = setup.loaded.name;
  RunRequest request = arguments.request;
  // Quality affects the exit code only if gates were requested.
  if (!arguments.gates.empty()) {
    RETARGET_TRY_ASSIGN(request.gates, changed_gates(arguments.gates, *data_folder));
  }
  if (!arguments.html.empty()) request.drawings.push_back(page_of_run(arguments.html));
  if (!arguments.png.empty()) {
    request.drawings.push_back(picture_of_run(arguments.png, arguments.strip));
  }
  RETARGET_TRY_ASSIGN(const RunOutcome outcome,
                      run_to_files(arguments.run, request, setup, console));
  if (!request.gates || outcome.quality->passed()) return kDone;
  return run_failure(arguments.run.output == "-" ? "standard output" : arguments.run.output,
                     "the motion misses a gate: " + missed_gates_text(*outcome.quality),
                     "the motion was written nevertheless");
}

}  // namespace retarget::cli
