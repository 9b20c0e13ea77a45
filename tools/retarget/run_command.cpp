// The default command: one motion file to one robot CSV.

#include <filesystem>

#include "clip_run.h"
#include "commands.h"
#include "retarget/base/file.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

Result<void> check_usage(const RunOptions& options) {
  if (options.source.file.empty()) {
    return usage_failure("no motion file is given",
                         "retarget --bvh walk.bvh --robot unitree_g1 "
                         "-o walk.csv; retarget --help shows more");
  }
  if (options.robot.empty() && options.robot_xml.empty()) {
    return usage_failure("no robot is given", "add --robot NAME or --robot-xml FILE");
  }
  if (!options.robot.empty() && !options.robot_xml.empty()) {
    return usage_failure("--robot and --robot-xml both name a robot", "give one of them");
  }
  if (!options.robot_profile.empty() && options.robot_xml.empty()) {
    return usage_failure("--robot-profile belongs to --robot-xml", "add --robot-xml FILE");
  }
  if (!options.robot_xml.empty() && options.ik_config.empty()) {
    return usage_failure("--robot-xml comes without a mapping", "add --ik-config FILE");
  }
  if (options.output.empty()) {
    return usage_failure("no output is given", "add -o FILE, or -o - for standard output");
  }
  if (options.method != "fit" && (!options.fit_config.empty() || !options.without.empty())) {
    return usage_failure("--fit-config and --without belong to --method fit", "leave out --method");
  }
  if (!options.frames.empty() && (options.start_s >= 0.0 || options.end_s >= 0.0)) {
    return usage_failure("--frames and --start/--end both choose a part of the clip",
                         "give one of them");
  }
  for (const std::string_view end : {".npz", ".pkl"}) {
    if (options.output.ends_with(end)) {
      return usage_failure(
          "the output \"" + options.output + "\" is no CSV: CSV is what is written",
          "give a name that ends in .csv");
    }
  }
  std::error_code ignored;
  if (options.output != "-" && fs::equivalent(options.source.file, options.output, ignored)) {
    return usage_failure("the output would overwrite the input \"" + options.source.file + "\"",
                         "give another name with -o");
  }
  if (options.report == "-") {
    return usage_failure("--report needs a file", "retarget evaluate --json - prints a report");
  }
  if (!options.report.empty()) {
    if (auto folder = check_output_folder(options.report); !folder) return folder;
  }
  return check_output_folder(options.output);
}

Result<void> run_checked(RunOptions options, Console& console) {
  if (auto chosen = choose_motion_file(options); !chosen) return chosen;
  if (auto usage = check_usage(options); !usage) return usage;
  const auto data_folder = data_folder_of(options.common);
  if (!data_folder) return failure(data_folder.error());
  const auto setup = load_robot_setup(options, *data_folder, console);
  if (!setup) return failure(setup.error());
  return run_clip(options, *setup, *data_folder, console);
}

}  // namespace

ExitCode run(const RunOptions& options, Console& console) {
  const auto done = run_checked(options, console);
  return done ? kDone : console.fail(done.error());
}

}  // namespace retarget::cli
