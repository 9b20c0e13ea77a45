#include <array>
#include <limits>
#include <string>
#include <utility>

#include "argument_tables.h"
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
    {Edit::kTrim, "trim", "Cut out a part of the clip"},
    {Edit::kMirror, "mirror", "Mirror the motion: swap left and right"},
    {Edit::kGround, "ground", "Raise or lower the motion so that the floor is at height 0"},
    {Edit::kTurn, "turn", "Turn the motion about the vertical axis at its start"},
    {Edit::kMove, "move", "Move the motion over the ground (axes: docs/editing.md)"},
    {Edit::kLoop, "loop", "Make a cycle from the first frame to the most similar one"},
    {Edit::kConcat, "concat", "Join clips where they fit best, on the first clip's skeleton"},
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

}  // namespace

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
