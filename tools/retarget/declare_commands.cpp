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

CLI::App* add_evaluate_command(CLI::App& app, EvaluateOptions& options) {
  CLI::App* command = app.add_subcommand(
      "evaluate", "Measure robot motions; exit code 1 when a gate is missed (docs/quality.md)");
  RunOptions& run = options.run;
  command
      ->add_option("motions", options.motions,
                   "Robot motions, CSV, NPZ or pickle; - reads standard\ninput")
      ->required()
      ->type_name("MOTION...");
  add_motion_options(*command, run);
  command->get_option("--bvh")->description("The movement that the motions came from");
  command->get_option("--smpl")->description("The same as SMPL or SMPL-X motion, NPZ");
  add_source_options(*command, run.source);
  add_lead_in_option(*command, run);
  command->add_option("--start", run.start_s, "Where in the source the motions begin, seconds")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kInput);
  command->get_option("--source-fps")
      ->description(
          "Frames per second of the source, whatever its header\nsays; without a source: of the "
          "motions");
  add_reading_layout(*command, options.reading);
  // what convert calls --source-quat had this name here
  command->add_option("--csv-quat", options.reading.quaternion)
      ->check(silent(CLI::IsMember({"xyzw", "wxyz"})))
      ->group("");
  add_human_options(*command, run.human);
  command->add_option("--robot", run.robot, "Robot by name, or a robot folder")
      ->type_name("NAME")
      ->group(kRobot);
  command->add_option("--robot-xml", run.robot_xml, "Any other robot: its MJCF model")
      ->type_name("FILE")
      ->group(kRobot);
  command->add_option("--robot-profile", run.robot_profile, "Profile of --robot-xml, JSON")
      ->type_name("FILE")
      ->group(kRobot);
  command
      ->add_option("--ik-config", run.ik_config,
                   "Mapping whose targets are tracked (default: as in a run)")
      ->type_name("published|derived|FILE")
      ->group(kRobot);
  command
      ->add_option("--limits", run.limits,
                   "Joint limits: a set of the robot, or a JSON or MJCF file\n"
                   "(default: the robot's own)")
      ->type_name("SET|FILE")
      ->group(kRobot);
  command
      ->add_option("--scale", run.scale, "How the body's size scales the targets that are tracked")
      ->type_name("auto|table|height|limbs")
      ->check(silent(CLI::IsMember({"auto", "table", "height", "limbs"})))
      ->capture_default_str()
      ->group(kRobot);
  run.fps.clear();
  command
      ->add_option("--fps", run.fps,
                   "Rate of motions whose files say none, in frames per\nsecond, or `source`; the "
                   "source is resampled to it\n(default: 30; of SOMA's 120)")
      ->type_name("N|source")
      ->group(kTime);
  command
      ->add_option("--json", options.json,
                   "Write the report as JSON; - writes standard output, in\nplace of the table")
      ->type_name("FILE")
      ->group(kOutput);
  command
      ->add_option("--gate", options.gates,
                   "What to ask for beyond configs/quality/default.json, or\ninstead: a file like "
                   "it, METRIC=MOST, METRIC=none, or none\nfor no gates at all; repeatable")
      ->type_name("FILE|METRIC=N")
      ->take_all()
      ->allow_extra_args(false)
      ->group(kOutput);
  add_common_options(*command, run.common);
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
