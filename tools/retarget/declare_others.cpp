// The commands that are not about runs.

#include "argument_tables.h"
#include "arguments.h"
#include "declare.h"
#include "declare_table.h"
#include "options/option_table.h"
#include "options/run_tables.h"

namespace retarget::cli {

CLI::App* add_inspect_command(CLI::App& app, InspectArguments& arguments) {
  CLI::App* command = app.add_subcommand("inspect", "Show what a motion file contains");
  declare(*command, {word("file", arguments.run.run.motion, "FILE",
                          "BVH, FBX, glTF, VRM, MVNX; SMPL or places of joints as NPZ, .npy, .pt, "
                          ".pkl; - reads standard input")});
  declare(*command, inspect_table(arguments));
  return command;
}

CLI::App* add_convert_command(CLI::App& app, ConvertArguments& arguments) {
  CLI::App* command = app.add_subcommand("convert", "Convert a robot motion to other file formats");
  declare(*command,
          {word("input", arguments.input, "IN", "CSV, NPZ or pickle; - reads standard input"),
           word("out", arguments.output, "OUT", "File to write, as -o", false)});
  declare(*command, convert_table(arguments));
  command->get_option("--interpolation")->description("Between frames");
  command->get_option("--no-antialias")->description("Do not low-pass when lowering the rate");
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
  CLI::App* command = app.add_subcommand(
      "view",
      "Write a page that plays robot motions, HTML, or draw one as a strip of poses, PNG or SVG");
  declare(*command,
          {word("motions", arguments.motions, "MOTION...",
                "Robot motions, CSV, NPZ or pickle; several are played side by side; - reads "
                "standard input; or the output folder of a batch")});
  declare(*command, view_table(arguments));
  const auto describe_as = [command](const char* name, const char* help) {
    command->get_option(name)->description(help);
  };
  describe_as("--output",
              "Page (.html) or picture (.png, else SVG); - writes an SVG to standard output; of a "
              "folder: the gallery's folder");
  command->get_option("--output")->required();
  describe_as("--bvh", "The source of the motions, drawn beside them");
  describe_as("--smpl", "The same as SMPL or SMPL-X motion, NPZ");
  describe_as("--start", "Where in the source the motions begin, seconds");
  describe_as("--ik-config",
              "Page: retargeting configuration whose targets are tracked (default: as in a run)");
  describe_as(
      "--limits",
      "Page: joint limits: a set of the robot, or a JSON or MJCF file (default: the robot's own)");
  describe_as("--scale", "Page: how the body's size scales the targets that are tracked");
  return command;
}

CLI::App* add_robots_command(CLI::App& app, RobotsArguments& arguments) {
  CLI::App* command = app.add_subcommand("robots", "List, show, check and add robots");
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
                             "fixed: an upper body, whose base stands fast, on a stand, on wheels "
                             "or held; it needs no legs (default: as robot.json says)");
  const Option json = option("json", arguments.json, kOutputGroup, "", "Print JSON");
  add(RobotsAction::kList, "list", "List the robots", {json});
  add(RobotsAction::kShow, "show", "A robot's joints, limits, retargeting configuration and size",
      {robot("ROBOT", "Name or folder"), json});
  add(RobotsAction::kCheck, "check", "List errors and oddities of a robot; exit code 4 on errors",
      {robot("ROBOT", "Name, folder or model file"), base});
  add(RobotsAction::kAdd, "add", "Make a robot's folder from a model",
      {word("name", arguments.robot, "NAME", "The new robot's name"),
       option("model", arguments.model, kInputGroup, "FILE", "MJCF, or URDF; meshes are not needed",
              {.required = true}),
       base,
       option("output", arguments.output, kOutputGroup, "DIR",
              "Folder to put the robot's folder into", {.letter = "o"}),
       option("force", arguments.force, kOutputGroup, "", "Replace an existing folder")});
  return command;
}

}  // namespace retarget::cli
