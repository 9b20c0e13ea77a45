// Declares the default command and the commands that process its results.

#include "declare.h"
#include "argument_tables.h"
#include "arguments.h"
#include "declare_table.h"
#include "retarget/option_table.h"

namespace retarget::cli {
namespace {

void describe_as(CLI::App& command, const char* name, const char* help) {
  command.get_option(name)->description(help);
}

// Describes options of a run for a command that reads its motions.
void describe_source(CLI::App& command) {
  describe_as(command, "--smpl", "SMPL or SMPL-X source of the motions, NPZ");
  describe_as(command, "--start", "Start time of the motions in the source, seconds");
  describe_as(command, "--end", "End time of the motions in the source, seconds, inclusive");
  describe_as(command, "--source-fps",
              "Frames per second of the source; overrides its header; without a source: frame "
              "rate of the motions");
}

// Declares what commands that measure motions have in common. The rows of the command's own table
// replace those of a run.
void declare_measuring(CLI::App& app, const OptionTable& own, MeasureArguments& arguments) {
  CLI::App* const command = &app;
  const OptionTable of_run =
      without_rows_of(own, rows_for(OptionUse::kMeasure, run_command_table(arguments.run)));
  const OptionTable reading = without_rows_of(of_run, reading_table(arguments.reading));
  declare(*command, of_run);
  declare(*command, reading);
  declare(*command, own);
  describe_as(*command, "--bvh", "Source of the motions");
  describe_source(*command);
  describe_as(*command, "--ik-config",
              "Retargeting configuration for tracking errors (default: as in a run)");
  describe_as(
      *command, "--limits",
      "Joint limits: a set of the robot, or a JSON or MJCF file (default: the robot's own)");
  describe_as(*command, "--scale", "Scaling of the targets for tracking errors");
}

}  // namespace

CLI::App* add_run_command(CLI::App& app, RunArguments& arguments) {
  declare(app, run_command_table(arguments));
  // --bvh is an odd name for a robot motion, so --motion is an alias.
  declare(app, {option("motion", arguments.run.motion, kInputGroup, "FILE", "Same as --bvh",
                       {.decides = false})});
  app.get_option("--motion")->group("");
  for (const char* terms : {"--with", "--without"}) app.get_option(terms)->allow_extra_args();
  declare(app,
          {word("motion", arguments.words[0], "[MOTION]",
                "Motion to retarget: BVH, FBX, glTF, VRM, MVNX; SMPL or joint positions as NPZ, "
                ".npy, .pt, .pkl",
                false),
           word("robot-name", arguments.words[1], "[ROBOT]", "The robot, same as --robot", false)});
  return &app;
}

CLI::App* add_evaluate_command(CLI::App& app, EvaluateArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("evaluate", "Measure motions, check gates (docs/quality.md)");
  declare(*command, {word("motions", arguments.motions, "MOTION...",
                          "Robot motions, CSV, NPZ or pickle; - reads standard input")});
  declare_measuring(*command, evaluate_table(arguments), arguments);
  return command;
}

CLI::App* add_certify_command(CLI::App& app, CertifyArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("certify", "Measure, simulate, predict (docs/certificate.md)");
  declare(*command,
          {word("motion", arguments.motions, "MOTION", "Robot motion, CSV, NPZ or pickle")});
  declare_measuring(*command, certify_table(arguments), arguments);
  return command;
}

CLI::App* add_simulate_command(CLI::App& app, SimulateArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("simulate", "Replay a motion in simulation (docs/simulation.md)");
  declare(*command, {word("motion", arguments.input, "MOTION",
                          "Robot motion, CSV, NPZ or pickle; - reads standard input")});
  declare(*command, simulate_table(arguments));
  return command;
}

CLI::App* add_verify_command(CLI::App& app, VerifyArguments& arguments) {
  CLI::App* command = app.add_subcommand("verify", "Verify a recorded run or a certificate");
  declare(*command, {word("file", arguments.file, "FILE",
                          "The sidecar, such as walk.csv.json, or a certificate")});
  declare(*command, common_table(arguments.common));
  return command;
}

// Declares the commands that do not concern runs.

CLI::App* add_inspect_command(CLI::App& app, InspectArguments& arguments) {
  CLI::App* command = app.add_subcommand("inspect", "Show the contents of a motion file");
  declare(*command, {word("file", arguments.run.run.motion, "FILE",
                          "BVH, FBX, glTF, VRM, MVNX; SMPL or joint positions as NPZ, .npy, .pt, "
                          ".pkl; - reads standard input")});
  declare(*command, inspect_table(arguments));
  return command;
}

CLI::App* add_contacts_command(CLI::App& app, ContactsArguments& arguments) {
  CLI::App* command = app.add_subcommand("contacts", "List the contacts of a run (docs/world.md)");
  declare(*command, {word("motion", arguments.run.run.motion, "MOTION", "Motion to retarget")});
  declare(*command, contacts_table(arguments));
  for (const char* terms : {"--with", "--without"}) command->get_option(terms)->allow_extra_args();
  return command;
}

CLI::App* add_scene_from_motion_command(CLI::App& app, SceneFromMotionArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("scene-from-motion", "Detect steps, seats and rails (docs/world.md)");
  declare(*command, {word("motion", arguments.run.run.motion, "MOTION", "Motion of a human")});
  declare(*command, scene_from_motion_table(arguments));
  return command;
}

CLI::App* add_convert_command(CLI::App& app, ConvertArguments& arguments) {
  CLI::App* command = app.add_subcommand("convert", "Convert a motion to other file formats");
  declare(*command,
          {word("input", arguments.request.input, "IN",
                "Robot motion, CSV, NPZ or pickle (- reads standard input), or human motion"),
           word("out", arguments.request.output, "OUT", "File to write, same as -o", false)});
  declare(*command, convert_table(arguments));
  command->get_option("--interpolation")->description("Interpolation between frames");
  command->get_option("--no-antialias")
      ->description("Do not low-pass filter when lowering the rate");
  return command;
}

CLI::App* add_compare_command(CLI::App& app, CompareArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("compare", "Compare two motions; exit code 1 if they differ");
  declare(*command, {word("a", arguments.a, "A", "CSV, NPZ or pickle"),
                     word("b", arguments.b, "B", "CSV, NPZ or pickle to compare with A")});
  declare(*command, compare_table(arguments));
  return command;
}

CLI::App* add_view_command(CLI::App& app, ViewArguments& arguments) {
  CLI::App* command = app.add_subcommand("view", "Show motions: an HTML page, or a strip of poses");
  declare(*command, {word("motions", arguments.motions, "MOTION...",
                          "Robot motions, CSV, NPZ or pickle (several play side by side); - reads "
                          "standard input; or the output folder of a batch")});
  declare(*command, view_table(arguments));
  describe_as(*command, "--output",
              "Page (.html) or strip of poses (.png, otherwise SVG); - writes an SVG to standard "
              "output; for a "
              "batch: the gallery folder");
  command->get_option("--output")->required();
  describe_as(*command, "--bvh", "Source of the motions, drawn next to them");
  describe_source(*command);
  describe_as(*command, "--scene",
              "Page: the scene around the human, drawn as the robot's world; without --bvh, the "
              "robot's world itself (docs/viewing.md)");
  describe_as(*command, "--object-track",
              "Page: paths of moving bodies of --scene (docs/world.md)");
  describe_as(*command, "--ik-config",
              "Page: retargeting configuration for tracking errors (default: as in a run)");
  describe_as(
      *command, "--limits",
      "Page: joint limits: a set of the robot, or a JSON or MJCF file (default: the robot's own)");
  describe_as(*command, "--scale", "Page: scaling of the targets for tracking errors");
  return command;
}

}  // namespace retarget::cli
