// Declares the commands that do not concern runs.

#include "argument_tables.h"
#include "arguments.h"
#include "declare.h"
#include "declare_table.h"
#include "retarget/option_table.h"

namespace retarget::cli {

CLI::App* add_inspect_command(CLI::App& app, InspectArguments& arguments) {
  CLI::App* command = app.add_subcommand("inspect", "Show what a motion file contains");
  declare(*command, {word("file", arguments.run.run.motion, "FILE",
                          "BVH, FBX, glTF, VRM, MVNX; SMPL or joint positions as NPZ, .npy, .pt, "
                          ".pkl; - reads standard input")});
  declare(*command, inspect_table(arguments));
  return command;
}

CLI::App* add_convert_command(CLI::App& app, ConvertArguments& arguments) {
  CLI::App* command = app.add_subcommand("convert", "Convert a robot motion to other file formats");
  declare(*command,
          {word("input", arguments.input, "IN", "CSV, NPZ or pickle; - reads standard input"),
           word("out", arguments.output, "OUT", "File to write, same as -o", false)});
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
                     word("b", arguments.b, "B", "The other")});
  declare(*command, compare_table(arguments));
  return command;
}

CLI::App* add_view_command(CLI::App& app, ViewArguments& arguments) {
  CLI::App* command = app.add_subcommand("view",
                                         "Write an HTML page that plays robot motions, or draw a "
                                         "motion as a strip of poses, PNG or SVG");
  declare(*command,
          {word("motions", arguments.motions, "MOTION...",
                "Robot motions, CSV, NPZ or pickle; several are played side by side; - reads "
                "standard input; or the output folder of a batch")});
  declare(*command, view_table(arguments));
  const auto describe_as = [command](const char* name, const char* help) {
    command->get_option(name)->description(help);
  };
  describe_as("--output",
              "Page (.html) or picture (.png, else SVG); - writes an SVG to standard output; for a "
              "batch: the gallery folder");
  command->get_option("--output")->required();
  describe_as("--bvh", "Source of the motions, drawn next to them");
  describe_as("--smpl", "The same, as an SMPL or SMPL-X motion, NPZ");
  describe_as("--start", "Start time of the motions in the source, seconds");
  describe_as("--ik-config",
              "Page: retargeting configuration for tracking errors (default: as in a run)");
  describe_as(
      "--limits",
      "Page: joint limits: a set of the robot, or a JSON or MJCF file (default: the robot's own)");
  describe_as("--scale", "Page: scaling of the targets for tracking errors");
  return command;
}

CLI::App* add_robots_command(CLI::App& app, RobotsArguments& arguments) {
  CLI::App* command = app.add_subcommand("robots", "List, show, check, add and install robots");
  command->require_subcommand(1);
  const auto add = [&](RobotsAction action, const char* name, const char* help, OptionTable rows) {
    CLI::App* each = command->add_subcommand(name, help);
    each->parse_complete_callback([&arguments, action] { arguments.action = action; });
    append(rows, common_table(arguments.common));
    declare(*each, rows);
  };
  const auto robot = [&](const char* type, const char* help) {
    return word("robot", arguments.robot, type, help);
  };
  const Option base = option("base", arguments.base, kRobotGroup, "",
                             "fixed: an upper body with a fixed base (on a stand or a wheeled "
                             "platform); it needs no legs (default: from robot.json)");
  const Option json = option("json", arguments.json, kOutputGroup, "", "Print JSON");
  add(RobotsAction::kList, "list", "List the robots", {json});
  add(RobotsAction::kShow, "show",
      "Show a robot's joints, limits, retargeting configuration and size",
      {robot("ROBOT", "Name or folder"), json});
  add(RobotsAction::kCheck, "check", "List errors and anomalies of a robot; exit code 4 on errors",
      {robot("ROBOT", "Name, folder or model file"), base});
  add(RobotsAction::kAdd, "add", "Create a robot folder from a model",
      {word("name", arguments.robot, "NAME", "Name of the new robot"),
       option("model", arguments.model, kInputGroup, "FILE", "MJCF or URDF; meshes are not needed",
              {.required = true}),
       base,
       option("output", arguments.output, kOutputGroup, "DIR",
              "Parent folder of the new robot folder", {.letter = "o"}),
       option("force", arguments.force, kOutputGroup, "", "Replace an existing folder")});
  add(RobotsAction::kInstall, "install",
      "Install robots that packages omit because their makers state no licence",
      {word("names", arguments.names, "NAME...",
            "Full names of robots (default: all robots in SOURCE that are not installed)", false),
       option("source", arguments.source, kInputGroup, "SOURCE",
              "Source tree of retarget, or retarget-robots-unverified.zip", {.required = true}),
       option("output", arguments.install_folder, kOutputGroup, "DIR",
              "Parent folder of the robot folders (default: the user's own robots, "
              "$XDG_DATA_HOME/retarget/robots)",
              {.letter = "o"}),
       option("force", arguments.force, kOutputGroup, "", "Replace existing robots")});
  return command;
}

}  // namespace retarget::cli
