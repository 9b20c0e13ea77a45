// Declares the default command and the commands that process its results.

#include <array>
#include <limits>
#include <string>
#include <utility>

#include "argument_tables.h"
#include "arguments.h"
#include "declare.h"
#include "declare_table.h"
#include "edit_arguments.h"
#include "retarget/edit.h"
#include "retarget/enum_names.h"
#include "retarget/option_table.h"

namespace retarget::cli {
namespace {

// One kind of edit: `retarget edit NAME IN ... -o OUT`.
struct EditKind {
  Edit edit;
  const char* name;
  const char* help;
};

constexpr std::array<EditKind, 12> kEdits = {{
    {Edit::kRest, "rest",
     "Transfer the motion to a skeleton with the same joints and another rest pose"},
    {Edit::kTransfer, "transfer", "Transfer the motion to another skeleton through the T-pose"},
    {Edit::kLafan1, "lafan", "Convert the clip to the LAFAN1 skeleton"},
    {Edit::kResample, "resample", "Change the frame rate or the speed"},
    {Edit::kTrim, "trim", "Extract an interval of the clip"},
    {Edit::kMirror, "mirror", "Mirror the motion: swap left and right"},
    {Edit::kGround, "ground", "Raise or lower the motion so that the floor is at height 0"},
    {Edit::kTurn, "turn", "Turn the motion about the vertical axis at its start"},
    {Edit::kMove, "move", "Move the motion over the ground (axes: docs/editing.md)"},
    {Edit::kLoop, "loop", "Make a cycle from the first frame to the most similar one"},
    {Edit::kConcat, "concat", "Join clips at the best seam, on the first clip's skeleton"},
    {Edit::kPath, "path", "Fit or draw the path over the ground, or follow another path"},
}};

Option file(const char* name, std::string& member, const char* help) {
  return option(name, member, kOutputGroup, "FILE", help);
}

Option like_row(const char* name, std::string& member) {
  return option(name, member, kInputGroup, "FILE", "BVH with the target skeleton",
                {.required = true});
}

// Returns the options specific to one edit.
OptionTable own_table(Edit edit, EditArguments& arguments) {
  switch (edit) {
    case Edit::kRest:
      return {like_row("like", arguments.like)};
    case Edit::kTransfer:
      return {like_row("to", arguments.like)};
    case Edit::kResample:
      return resample_table(arguments);
    case Edit::kGround:
      return ground_table(arguments);
    case Edit::kTurn: {
      OptionTable table = {
          word("degrees", arguments.degrees, "DEG", "Angle, positive to the left")};
      table.front().info.min = -1e6;
      table.front().info.max = 1e6;
      return table;
    }
    case Edit::kMove:
      return {word("shift", arguments.shift, "X,Y", "Along x and y, metres")};
    case Edit::kLoop:
      return loop_table(arguments);
    case Edit::kConcat: {
      OptionTable table = concatenate_table(arguments);
      table.push_back(file("matrix", arguments.matrix,
                           "Write the pose distances of the (first) seam search as an image, PGM"));
      return table;
    }
    case Edit::kPath: {
      OptionTable table = {
          file("fit", arguments.fit, "Write the motion's own path for editing, JSON"),
          file("svg", arguments.svg, "Draw the paths and the feet, seen from above")};
      append(table, path_table(arguments));
      return table;
    }
    default:
      return {};
  }
}

OptionTable edit_table(Edit edit, EditArguments& arguments) {
  OptionTable table = {
      edit == Edit::kConcat
          ? word("files", arguments.files, "FILE...", "Motions to join, in order, BVH")
          : word("file", arguments.file, "FILE", "Motion to edit, BVH; - reads standard input")};
  append(table, own_table(edit, arguments));
  if (edit >= Edit::kResample && edit != Edit::kConcat) {
    append(table, rows_for(OptionUse::kEdit, part_table(arguments.part)));
  }
  append(table, rows_for(OptionUse::kEdit, source_table(arguments.source)));
  if (edit != Edit::kRest && edit != Edit::kResample && edit != Edit::kTrim) {
    append(table, rows_for(OptionUse::kEdit, human_table(arguments.human)));
    table.push_back(write_map_row(arguments.write_map));
  }
  Option output = output_row(arguments.output);
  output.info.help = "BVH to write, or a GLB for viewing; - writes standard output";
  output.info.required = edit != Edit::kPath;
  table.push_back(std::move(output));
  append(table, common_table(arguments.common));
  return table;
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
  describe_as("--smpl", "SMPL or SMPL-X source of the motions, NPZ");
  describe_as("--start", "Start time of the motions in the source, seconds");
  describe_as("--end", "End time of the motions in the source, seconds, inclusive");
  describe_as("--source-fps",
              "Frames per second of the source; overrides its header; without a source: frame "
              "rate of the motions");
  describe_as("--ik-config",
              "Retargeting configuration for tracking errors (default: as in a run)");
  describe_as(
      "--limits",
      "Joint limits: a set of the robot, or a JSON or MJCF file (default: the robot's own)");
  describe_as("--scale", "Scaling of the targets for tracking errors");
}

}  // namespace

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

CLI::App* add_live_command(CLI::App& app, LiveArguments& arguments) {
  CLI::App* command = app.add_subcommand("live", "Retarget a stream in real time (docs/live.md)");
  declare(*command, live_command_table(arguments));
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
  const auto describe_as = [command](const char* name, const char* help) {
    command->get_option(name)->description(help);
  };
  describe_as("--output",
              "Page (.html) or strip of poses (.png, otherwise SVG); - writes an SVG to standard "
              "output; for a "
              "batch: the gallery folder");
  command->get_option("--output")->required();
  describe_as("--bvh", "Source of the motions, drawn next to them");
  describe_as("--smpl", "SMPL or SMPL-X source of the motions, NPZ");
  describe_as("--start", "Start time of the motions in the source, seconds");
  describe_as("--end", "End time of the motions in the source, seconds, inclusive");
  describe_as("--scene",
              "Page: the scene around the human, drawn as the robot's world; without --bvh, the "
              "robot's world itself (docs/viewing.md)");
  describe_as("--object-track", "Page: paths of moving bodies of --scene (docs/world.md)");
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
  add(RobotsAction::kCompare, "compare",
      "Compare a robot with another model of it; exit code 1 if they differ",
      {robot("ROBOT", "Name or folder"),
       option("model", arguments.model, kInputGroup, "FILE",
              "MJCF or URDF with the same names, such as the maker's", {.required = true})});
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

CLI::App* add_edit_command(CLI::App& app, EditArguments& arguments) {
  CLI::App* command = app.add_subcommand("edit", "Change a motion: BVH in, BVH out");
  command->require_subcommand(1);
  for (const auto& [edit, name, help] : kEdits) {
    CLI::App* each = command->add_subcommand(name, help);
    each->parse_complete_callback([&arguments, edit = edit] { arguments.edit = edit; });
    declare(*each, edit_table(edit, arguments));
  }
  return command;
}

}  // namespace retarget::cli
