// Declares the default command and the commands that process its results.

#include "argument_tables.h"
#include "arguments.h"
#include "declare.h"
#include "declare_table.h"
#include "retarget/option_table.h"

namespace retarget::cli {

void add_run_options(CLI::App& app, RunArguments& arguments) {
  declare(app, run_command_table(arguments));
  // --bvh is an odd name for a robot motion, so --motion is an alias.
  declare(app, {option("motion", arguments.run.motion, kInputGroup, "FILE", "Same as --bvh",
                       {.decides = false})});
  app.get_option("--motion")->group("");
  for (const char* terms : {"--with", "--without"}) app.get_option(terms)->allow_extra_args();
}

void add_run_words(CLI::App& app, RunArguments& arguments) {
  declare(app,
          {word("motion", arguments.words[0], "[MOTION]",
                "Motion to retarget: BVH, FBX, glTF, VRM, MVNX; SMPL or joint positions as NPZ, "
                ".npy, .pt, .pkl",
                false),
           word("robot-name", arguments.words[1], "[ROBOT]", "The robot, same as --robot", false)});
}

CLI::App* add_batch_command(CLI::App& app, BatchArguments& arguments) {
  CLI::App* command = app.add_subcommand("batch", "Retarget folders of clips (docs/batch.md)");
  declare(*command, {word("inputs", arguments.request.inputs, "IN...",
                          "Files, folders (searched recursively), patterns, or @LIST for a file "
                          "with names; with --merge, further manifests",
                          false)});
  // The rows of a batch replace those of a run.
  declare(*command,
          without_rows_of(batch_table(arguments),
                          rows_not_for(OptionUse::kOneClip, run_command_table(arguments.run))));
  declare(*command, batch_table(arguments));
  for (const char* terms : {"--with", "--without"}) command->get_option(terms)->allow_extra_args();
  return command;
}

CLI::App* add_evaluate_command(CLI::App& app, EvaluateArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure robot motions; exit code 1 if a gate is missed (docs/quality.md)");
  declare(*command, {word("motions", arguments.motions, "MOTION...",
                          "Robot motions, CSV, NPZ or pickle; - reads standard input")});
  const OptionTable own = evaluate_table(arguments);
  const OptionTable of_run =
      without_rows_of(own, rows_for(OptionUse::kMeasure, run_command_table(arguments.run)));
  const OptionTable reading = without_rows_of(of_run, reading_table(arguments.reading));
  declare(*command, of_run);
  declare(*command, reading);
  // Here, the option that convert calls --source-quat keeps its old name.
  Option quaternion = *find_option(reading, "source-quat");
  quaternion.name = "csv-quat";
  declare(*command, {quaternion});
  command->get_option("--csv-quat")->group("");
  declare(*command, own);
  const auto describe_as = [command](const char* name, const char* help) {
    command->get_option(name)->description(help);
  };
  describe_as("--bvh", "Source of the motions");
  describe_as("--smpl", "The same, as an SMPL or SMPL-X motion, NPZ");
  describe_as("--start", "Start time of the motions in the source, seconds");
  describe_as("--source-fps",
              "Frames per second of the source; overrides its header; without a source: frame "
              "rate of the motions");
  describe_as("--ik-config",
              "Retargeting configuration for tracking errors (default: as in a run)");
  describe_as(
      "--limits",
      "Joint limits: a set of the robot, or a JSON or MJCF file (default: the robot's own)");
  describe_as("--scale", "Scaling of the targets for tracking errors");
  return command;
}

CLI::App* add_verify_command(CLI::App& app, VerifyArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("verify", "Check that a recorded run still gives identical output");
  declare(*command, {word("file", arguments.file, "FILE", "The sidecar, such as walk.csv.json")});
  declare(*command, common_table(arguments.common));
  return command;
}

}  // namespace retarget::cli
