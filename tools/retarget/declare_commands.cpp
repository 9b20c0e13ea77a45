#include "declare.h"
#include "declare_shared.h"

namespace retarget::cli {

CLI::App* add_inspect_command(CLI::App& app, InspectOptions& options) {
  CLI::App* command = app.add_subcommand("inspect", "Show what a motion file holds");
  command->add_option("file", options.source.file, "BVH or SMPL NPZ; - reads standard input")
      ->required()
      ->type_name("FILE");
  add_source_options(*command, options.source);
  command
      ->add_flag("--skeleton", options.skeleton_only,
                 "The skeleton is enough: accept a file without MOTION")
      ->group(kInput);
  add_human_options(*command, options.human);
  command->add_flag("--json", options.json, "Print JSON on standard output")->group(kOutput);
  command
      ->add_option("--positions", options.positions,
                   "Write world positions and quaternions (xyzw) of all joints and end sites, "
                   "in the file's units and axes, as CSV; - writes standard output")
      ->type_name("FILE")
      ->group(kOutput);
  add_common_options(*command, options.common);
  return command;
}

namespace {

// `retarget robots WORD`
CLI::App* add_robots_action(CLI::App& robots, RobotsOptions& options, RobotsAction action,
                            const char* name, const char* description) {
  CLI::App* command = robots.add_subcommand(name, description);
  command->parse_complete_callback([&options, action] { options.action = action; });
  if (action == RobotsAction::kList || action == RobotsAction::kShow) {
    command->add_flag("--json", options.json, "Print JSON")->group(kOutput);
  }
  add_common_options(*command, options.common);
  return command;
}

}  // namespace

CLI::App* add_robots_command(CLI::App& app, RobotsOptions& options) {
  CLI::App* command = app.add_subcommand("robots", "List, show, check and add robots");
  command->require_subcommand(1);
  add_robots_action(*command, options, RobotsAction::kList, "list", "The robots that are there");
  CLI::App* show = add_robots_action(*command, options, RobotsAction::kShow, "show",
                                     "A robot's joints, limits, mapping and size");
  show->add_option("robot", options.robot, "Name or folder")->required()->type_name("ROBOT");
  CLI::App* check = add_robots_action(*command, options, RobotsAction::kCheck, "check",
                                      "Every fault and oddity of a robot; exit code 4 on faults");
  check->add_option("robot", options.robot, "Name, folder or model file")
      ->required()
      ->type_name("ROBOT");
  CLI::App* add = add_robots_action(*command, options, RobotsAction::kAdd, "add",
                                    "Make a robot's folder from a model");
  add->add_option("name", options.robot, "The new robot's name")->required()->type_name("NAME");
  add->add_option("--model", options.model, "MJCF, or URDF; meshes are not needed")
      ->required()
      ->type_name("FILE")
      ->group(kInput);
  add->add_option("-o,--output", options.output, "Folder to put the robot's folder into")
      ->type_name("DIR")
      ->capture_default_str()
      ->group(kOutput);
  add->add_flag("--force", options.force, "Replace a folder that is there")->group(kOutput);
  return command;
}

}  // namespace retarget::cli
