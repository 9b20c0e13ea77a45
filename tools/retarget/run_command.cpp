// The default command: one motion file to a robot's motion files.

#include <string>
#include <vector>

#include "clip_run.h"
#include "commands.h"
#include "outputs.h"
#include "retarget/base/file.h"
#include "run_setup.h"

namespace retarget::cli {
namespace {

Result<void> check_usage(const RunOptions& options) {
  if (options.source.file.empty()) {
    return usage_failure("no motion file is given",
                         "retarget --bvh walk.bvh --robot unitree_g1 "
                         "-o walk.csv; retarget --help shows more");
  }
  if (auto solving = check_solving_options(options); !solving) return solving;
  if (options.report == "-") {
    return usage_failure("--report needs a file", "retarget evaluate --json - prints a report");
  }
  if (!options.report.empty()) {
    if (auto folder = check_output_folder(options.report); !folder) return folder;
  }
  const std::vector<std::string> inputs = {
      options.source.file, options.source.smpl_model, options.human.map, options.human.tpose_file,
      options.robot_xml,   options.robot_profile,     options.ik_config, options.limits,
      options.fit_config};
  return check_outputs(options, inputs, {options.report, options.human.write_map});
}

Result<void> run_checked(RunOptions options, Console& console) {
  if (auto chosen = choose_motion_file(options); !chosen) return chosen;
  if (auto usage = check_usage(options); !usage) return usage;
  const auto data_folder = data_folder_of(options.common);
  if (!data_folder) return failure(data_folder.error());
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
