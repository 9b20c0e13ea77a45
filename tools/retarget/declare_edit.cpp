#include <array>
#include <limits>
#include <string>
#include <utility>

#include "argument_tables.h"
#include "declare.h"
#include "declare_table.h"
#include "edit_arguments.h"
#include "options/enum_names.h"
#include "options/option_table.h"
#include "options/run_tables.h"
#include "retarget/edit.h"

namespace retarget {

template <>
inline constexpr auto kEnumNames<SeamBlend> = std::to_array<NamedValue<SeamBlend>>(
    {{SeamBlend::kCrossfade, "crossfade"}, {SeamBlend::kInertial, "inertial"}});
template <>
inline constexpr auto kEnumNames<PathKeep> = std::to_array<NamedValue<PathKeep>>(
    {{PathKeep::kTime, "time"}, {PathKeep::kSpeed, "speed"}, {PathKeep::kStride, "stride"}});

namespace cli {
namespace {

// one kind of edit: `retarget edit NAME IN ... -o OUT`
struct EditKind {
  Edit edit;
  const char* name;
  const char* help;
};

constexpr std::array<EditKind, 12> kEdits = {{
    {Edit::kRest, "rest",
     "The same movement on a skeleton of the same joints with another rest pose"},
    {Edit::kTransfer, "transfer", "Another skeleton, moved through the T-pose"},
    {Edit::kLafan1, "lafan", "A clip in the shape of LAFAN1"},
    {Edit::kResample, "resample", "Change the frame rate or the speed"},
    {Edit::kTrim, "trim", "A part of the clip"},
    {Edit::kMirror, "mirror", "The mirror image: left does what right did"},
    {Edit::kGround, "ground", "Raise or lower the motion so that the floor is at height 0"},
    {Edit::kTurn, "turn", "Turn the motion about the vertical, where it begins"},
    {Edit::kMove, "move", "Move the motion over the ground (docs/editing.md: its axes)"},
    {Edit::kLoop, "loop", "A cycle from the first frame to the one most like it"},
    {Edit::kConcat, "concat", "Join clips where they fit best; the first one's skeleton"},
    {Edit::kPath, "path", "The path over the ground: fit it, draw it, follow another"},
}};

Option number(const char* name, auto& member, const char* type, double min, double max,
              const char* help) {
  return option(name, member, kTimeGroup, type, help, {.min = min, .max = max});
}

Option choice(const char* name, auto& member, const char* help) {
  return option(name, member, kTimeGroup, "", help);
}

Option file(const char* name, std::string& member, const char* help) {
  return option(name, member, kOutputGroup, "FILE", help);
}

Option like_row(const char* name, std::string& member) {
  return option(name, member, kInputGroup, "FILE", "BVH with the target skeleton",
                {.required = true});
}

Option threshold_row(EditArguments& arguments) {
  return number("threshold", arguments.threshold_cm, "CM", 0.0, 1e6,
                "Largest distance of a seam, cm");
}

Option force_row(EditArguments& arguments) {
  return choice("force", arguments.force, "Join clips even if they do not fit");
}

OptionTable resample_table(EditArguments& arguments) {
  return {option("fps", arguments.fps, kTimeGroup, "N",
                 "Frames per second of the output (default: the source's)"),
          number("speed", arguments.timing.speed, "N", 0.01, 100.0,
                 "How many times as fast: 0.8 takes 1/0.8 of the time"),
          choice("interpolation", arguments.interpolation, "Between source frames"),
          choice("no-antialias", arguments.no_antialias,
                 "Do not low-pass a source that is faster than the output")};
}

OptionTable loop_table(EditArguments& arguments) {
  return {number("shortest", arguments.loop.shortest, "S", 0.0, kMaxTime,
                 "Shortest length of the cycle, seconds (default: half the clip)"),
          number("times", arguments.loop.times, "N", std::numeric_limits<int>::min(),
                 std::numeric_limits<int>::max(), "How many times the cycle is played"),
          choice("in-place", arguments.loop.in_place, "The body neither advances nor turns"),
          threshold_row(arguments), force_row(arguments)};
}

OptionTable concat_table(EditArguments& arguments) {
  return {option("search", arguments.search, kTimeGroup, "S|all",
                 "Where the seam is searched: this many seconds at the end of one and the "
                 "beginning of the other, or `all` (default: 2, and more while no seam is good)"),
          number("window", arguments.concat.seam.window, "S", 0.0, 10.0,
                 "Length of the part compared and blended, seconds (default: a third)"),
          choice("blend", arguments.concat.blend,
                 "Mix the frames that both have, or fade out the difference in the second"),
          threshold_row(arguments),
          force_row(arguments),
          file("matrix", arguments.matrix,
               "Write the searched distances as an image, PGM (of several seams: the "
               "first)")};
}

OptionTable path_table(EditArguments& arguments) {
  return {
      file("fit", arguments.fit, "Write the motion's own path, JSON, for editing"),
      file("svg", arguments.svg, "Draw the paths and the feet, seen from above"),
      option("to", arguments.path.to, kTimeGroup, "FILE|line|circle|figure8",
             "Path to follow: JSON, or a ready-made one with the length and start of the motion's "
             "own (default: its own)"),
      number("radius", arguments.path.radius, "M", -1e6, 1e6,
             "Radius of --to circle, metres; negative turns right"),
      number("scale", arguments.path.scale, "N", 0.001, 1000.0,
             "Make the path larger or smaller, from its beginning"),
      number("rotate", arguments.path.degrees, "DEG", -1e6, 1e6,
             "Turn the path about its beginning, degrees to the left"),
      choice("keep", arguments.follow_path.keep,
             "On a longer or shorter path: the duration (longer strides), the speed over the "
             "ground (slower motion), or the strides (the motion ends where its own way would)"),
      number("tolerance", arguments.follow_path.fit.tolerance, "M", 0.001, 100.0,
             "How far the fitted path may be from the track, metres")};
}

// what one edit takes and others do not
OptionTable own_table(Edit edit, EditArguments& arguments) {
  switch (edit) {
    case Edit::kRest:
      return {like_row("like", arguments.like)};
    case Edit::kTransfer:
      return {like_row("to", arguments.like)};
    case Edit::kResample:
      return resample_table(arguments);
    case Edit::kGround:
      return {option("floor", arguments.floor, kInputGroup, "H",
                     "Height of the floor in the source, metres (default: where the feet stand)",
                     {.min = -1e6, .max = 1e6})};
    case Edit::kTurn: {
      OptionTable table = {
          word("degrees", arguments.degrees, "DEG", "Angle; positive to the left")};
      table.front().info.min = -1e6;
      table.front().info.max = 1e6;
      return table;
    }
    case Edit::kMove:
      return {word("shift", arguments.shift, "X,Y", "Along x and y, metres")};
    case Edit::kLoop:
      return loop_table(arguments);
    case Edit::kConcat:
      return concat_table(arguments);
    case Edit::kPath:
      return path_table(arguments);
    default:
      return {};
  }
}

OptionTable edit_table(Edit edit, EditArguments& arguments) {
  OptionTable table = {
      edit == Edit::kConcat
          ? word("files", arguments.files, "FILE...", "Motions in their order, BVH")
          : word("file", arguments.file, "FILE", "Motion to edit, BVH; - reads standard input")};
  append(table, own_table(edit, arguments));
  if (edit >= Edit::kResample && edit != Edit::kConcat) {
    append(table, only(part_table(arguments.part), {"start", "end", "frames"}));
  }
  append(table, without(source_table(arguments.source), {"smpl-model"}));
  if (edit != Edit::kRest && edit != Edit::kResample && edit != Edit::kTrim) {
    append(table, human_table(arguments.human));
    table.push_back(write_map_row(arguments.write_map));
  }
  Option output = output_row(arguments.output);
  output.info.help = "BVH to write, or a GLB to look at; - writes standard output";
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

}  // namespace cli
}  // namespace retarget
