// The commands that are not about runs.

#include "argument_tables.h"
#include "declare.h"
#include "declare_table.h"
#include "options/run_tables.h"

namespace retarget::cli {

CLI::App* add_inspect_command(CLI::App& app, InspectArguments& arguments) {
  CLI::App* command = app.add_subcommand("inspect", "Show what a motion file holds");
  command->add_option("file", arguments.run.run.motion, "BVH or SMPL NPZ; - reads standard input")
      ->required()
      ->type_name("FILE");
  declare(*command, inspect_table(arguments));
  return command;
}

CLI::App* add_convert_command(CLI::App& app, ConvertArguments& arguments) {
  CLI::App* command =
      app.add_subcommand("convert", "A robot's motion from one file format to others");
  command->add_option("input", arguments.input, "CSV, NPZ or pickle; - reads standard input")
      ->required()
      ->type_name("IN");
  command->add_option("out", arguments.output, "File to write, as -o")->type_name("OUT");
  declare(*command, convert_table(arguments));
  command->get_option("--interpolation")->description("Between frames");
  command->get_option("--no-antialias")
      ->description("Do not low-pass a motion that goes to a lower rate");
  return command;
}

CLI::App* add_compare_command(CLI::App& app, CompareArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "compare", "Whether two motions agree, column by column; exit code 1 if not");
  command->add_option("a", arguments.a, "CSV, NPZ or pickle")->required()->type_name("A");
  command->add_option("b", arguments.b, "The other")->required()->type_name("B");
  declare(*command, compare_table(arguments));
  return command;
}

CLI::App* add_view_command(CLI::App& app, ViewArguments& arguments) {
  CLI::App* command = app.add_subcommand("view", "Draw a robot motion as a strip of poses, SVG");
  command->add_option("motion", arguments.motion, "CSV, NPZ or pickle; - reads standard input")
      ->required()
      ->type_name("MOTION");
  declare(*command, view_table(arguments));
  command->get_option("--output")
      ->description("SVG to write; - writes standard output")
      ->required();
  command->get_option("--bvh")->description(
      "The movement that the motion came from, drawn above it");
  command->get_option("--smpl")->description("The same as SMPL or SMPL-X motion, NPZ");
  command->get_option("--start")->description("Where in the source the motion begins, seconds");
  return command;
}

namespace {

// `retarget robots WORD`
CLI::App* add_robots_action(CLI::App& robots, RobotsArguments& arguments, RobotsAction action,
                            const char* name, const char* description) {
  CLI::App* command = robots.add_subcommand(name, description);
  command->parse_complete_callback([&arguments, action] { arguments.action = action; });
  if (action == RobotsAction::kList || action == RobotsAction::kShow) {
    command->add_flag("--json", arguments.json, "Print JSON")->group(kOutputGroup);
  }
  declare(*command, common_table(arguments.common));
  return command;
}

}  // namespace

CLI::App* add_robots_command(CLI::App& app, RobotsArguments& arguments) {
  CLI::App* command = app.add_subcommand("robots", "List, show, check and add robots");
  command->require_subcommand(1);
  add_robots_action(*command, arguments, RobotsAction::kList, "list", "The robots that are there");
  CLI::App* show = add_robots_action(*command, arguments, RobotsAction::kShow, "show",
                                     "A robot's joints, limits, mapping and size");
  show->add_option("robot", arguments.robot, "Name or folder")->required()->type_name("ROBOT");
  CLI::App* check = add_robots_action(*command, arguments, RobotsAction::kCheck, "check",
                                      "Every fault and oddity of a robot; exit code 4 on faults");
  check->add_option("robot", arguments.robot, "Name, folder or model file")
      ->required()
      ->type_name("ROBOT");
  CLI::App* add = add_robots_action(*command, arguments, RobotsAction::kAdd, "add",
                                    "Make a robot's folder from a model");
  add->add_option("name", arguments.robot, "The new robot's name")->required()->type_name("NAME");
  add->add_option("--model", arguments.model, "MJCF, or URDF; meshes are not needed")
      ->required()
      ->type_name("FILE")
      ->group(kInputGroup);
  add->add_option("-o,--output", arguments.output, "Folder to put the robot's folder into")
      ->type_name("DIR")
      ->capture_default_str()
      ->group(kOutputGroup);
  add->add_flag("--force", arguments.force, "Replace a folder that is there")->group(kOutputGroup);
  return command;
}

}  // namespace retarget::cli
