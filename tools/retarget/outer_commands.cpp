// Commands of outer modules: batch, edit, live, robots.

#include "outer_commands.h"

#include <array>
#include <string>
#include <utility>

#include "argument_tables.h"
#include "arguments.h"
#include "declare.h"
#include "declare_table.h"
#include "edit_arguments.h"
#include "retarget/batch.h"
#include "retarget/live_table.h"
#include "retarget/option_table.h"
#include "retarget/serve_table.h"

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

OptionTable batch_table(BatchArguments& arguments) {
  OptionTable table = retarget::batch_table(arguments.request, arguments.run.run);
  table.push_back(
      option("merge", arguments.merge, kBatchGroup, "",
             "Join the manifests of all shards in the output folder and write the summary",
             {.decides = false}));
  table.push_back(option("no-quality", arguments.no_quality, kBatchGroup, "",
                         "Do not measure the motions: faster, but the summary lists only failures",
                         {.decides = false}));
  return table;
}

OptionTable live_command_table(LiveArguments& arguments) {
  OptionTable table = serve_table(arguments.request);
  table.push_back(option("play", arguments.play, "Player", "FILE",
                         "Only send this motion to --to, as the capture system would",
                         {.basic = true}));
  append(table, noting_given(player_table(arguments.player), arguments.request.given));
  table.push_back(option("list", arguments.list, kInputGroup, "",
                         "List the input and output formats and exit", {.basic = true}));
  append(table, common_table(arguments.common));
  return table;
}

}  // namespace

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

CLI::App* add_live_command(CLI::App& app, LiveArguments& arguments) {
  CLI::App* command = app.add_subcommand("live", "Retarget a stream in real time (docs/live.md)");
  declare(*command, live_command_table(arguments));
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
       option("force", arguments.force, kOutputGroup, "",
              "Replace a folder that an earlier robots add created")});
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

OptionTable outer_option_table() {
  BatchArguments batch;
  LiveArguments live;
  OptionTable table = batch_table(batch);
  append(table, live_command_table(live));
  return table;
}

}  // namespace retarget::cli
