#include "argument_tables.h"

#include <utility>
#include <vector>

#include "outer_commands.h"
#include "retarget/measure.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/run.h"

namespace retarget::cli {
namespace {

constexpr OptionUse kMeasureOrShow = OptionUse::kMeasure | OptionUse::kShow;

Option row(const char* name, auto& member, const char* group, const char* type, const char* help,
           OptionInfo info = {}) {
  info.decides = false;
  return option(name, member, group, type, help, std::move(info));
}

}  // namespace

OptionTable common_table(CommonArguments& arguments) {
  return {row("quiet", arguments.quiet, kGeneralGroup, "", "Print errors only",
              {.letter = "q", .uses = kMeasureOrShow}),
          row("data-dir", arguments.data_dir, kGeneralGroup, "DIR",
              "Folder that contains robots/ and configs/ (default: $RETARGET_DATA_DIR, or found "
              "relative to the program)",
              {.uses = kMeasureOrShow})};
}

Option write_map_row(std::string& file) {
  return row("write-map", file, kHumanGroup, "FILE", "Write the bone map of this run, for editing",
             {.uses = kMeasureOrShow | OptionUse::kOneClip});
}

OptionTable request_table(RunArguments& arguments) {
  RunRequest& request = arguments.request;
  return {
      write_map_row(request.write_map),
      row("mirror", request.mirror, kInputGroup, "", "Mirror the motion: swap left and right",
          {.uses = kMeasureOrShow}),
      row("sidecar", request.sidecar, kOutputGroup, "",
          "Write FILE.json next to every output: hashes, options, detected properties, "
          "quality; retarget verify checks it"),
      row("report", request.report, kOutputGroup, "FILE",
          "Write a quality report, JSON as in retarget evaluate", {.uses = OptionUse::kOneClip}),
      dynamics_row(request.dynamics),
      row("html", arguments.html, kOutputGroup, "FILE",
          "Page that plays the motion (docs/viewing.md)", {.uses = OptionUse::kOneClip}),
      row("png", arguments.png, kOutputGroup, "FILE", "Also render a strip of poses as PNG",
          {.uses = OptionUse::kShow | OptionUse::kOneClip}),
      row("strip", arguments.strip, kOutputGroup, "N",
          "Strip: number of poses, including the first and last frame (default: 6)",
          {.min = 1.0, .max = 100.0, .uses = OptionUse::kShow | OptionUse::kOneClip}),
      row("verbose", request.verbose, kGeneralGroup, "",
          "Also print the cost of every fit term, before and after, and its worst frames",
          {.letter = "v", .uses = OptionUse::kOneClip})};
}

OptionTable run_command_table(RunArguments& arguments) {
  OptionTable table = {row("bvh", arguments.run.motion, kInputGroup, "FILE",
                           "Motion to retarget; - reads standard input",
                           {.basic = true, .uses = kMeasureOrShow | OptionUse::kOneClip}),
                       row("smpl", arguments.smpl_file, kInputGroup, "FILE",
                           "SMPL or SMPL-X motion to retarget (docs/smpl.md)",
                           {.basic = true, .uses = kMeasureOrShow | OptionUse::kOneClip})};
  // The command line spells these two --bvh and --smpl.
  append(table, without(run_table(arguments.run), {"motion", "smpl"}));
  append(table, request_table(arguments));
  table.push_back(gate_row(
      arguments.gates,
      "Exit code 1 if the motion misses a gate: default, 'METRIC<=N', a file (docs/quality.md)"));
  append(table, common_table(arguments.common));
  return table;
}

OptionTable evaluate_table(EvaluateArguments& arguments) {
  return {row("fps", arguments.fps, kTimeGroup, "N|source",
              "Frame rate of the source, and of motions whose files state none, in frames per "
              "second, or `source` (default: the rate of the first motion; files without one: 30, "
              "SOMA 120)"),
          row("json", arguments.json, kOutputGroup, "FILE",
              "Write the report as JSON; - writes standard output instead of the table",
              {.basic = true}),
          row("all", arguments.all, kOutputGroup, "",
              "Print all metrics (default: gates and the most important metrics)", {.basic = true}),
          dynamics_row(arguments.dynamics), gate_row(arguments.gates)};
}

OptionTable convert_table(ConvertArguments& arguments) {
  ConvertRequest& request = arguments.request;
  OptionTable table = {memory_row(request.memory_gb)};
  append(table, reading_table(request.reading));
  append(table, rows_for(OptionUse::kConvert, robot_table(request.robot)));
  append(table, time_table(request.time));
  table.push_back(output_row(request.output));
  append(table, without(save_table(request.save), {"scene-out"}));
  append(table, common_table(arguments.common));
  return table;
}

OptionTable certify_table(CertifyArguments& arguments) {
  return {row("fps", arguments.fps, kTimeGroup, "N|source",
              "Frame rate of the source, and of a motion whose file states none, in frames per "
              "second, or `source` (default: the rate of the motion; files without one: 30, "
              "SOMA 120)"),
          row("output", arguments.output, kOutputGroup, "FILE",
              "Certificate to write, JSON (default: MOTION.certificate.json); - writes standard "
              "output",
              {.basic = true, .letter = "o"}),
          gate_row(arguments.gates)};
}

OptionTable simulate_table(SimulateArguments& arguments) {
  OptionTable table = {memory_row(arguments.memory_gb)};
  append(table, reading_table(arguments.reading));
  append(table, rows_for(OptionUse::kConvert, robot_table(arguments.robot)));
  Option output = output_row(arguments.output);
  output.info.help = "Simulated motion to write; - writes standard output";
  table.push_back(std::move(output));
  table.push_back(
      row("report", arguments.report, kOutputGroup, "FILE", "Write the report as JSON"));
  table.push_back(
      row("json", arguments.json, kOutputGroup, "", "Print the report as JSON", {.basic = true}));
  append(table, without(save_table(arguments.save), {"scene-out"}));
  append(table, common_table(arguments.common));
  return table;
}

OptionTable contacts_table(ContactsArguments& arguments) {
  Run& run = arguments.run.run;
  OptionTable table = source_table(run.options.source);
  append(table, human_table(run.options.human));
  append(table, part_table(run.options.part));
  append(table, robot_table(run.robot));
  append(table, solve_table(run.options.solve));
  append(table, time_table(run.options.time));
  table.push_back(row("json", arguments.json, kOutputGroup, "FILE",
                      "Write the contacts as JSON; - writes standard output instead of the table",
                      {.basic = true}));
  append(table, common_table(arguments.run.common));
  return table;
}

OptionTable scene_from_motion_table(SceneFromMotionArguments& arguments) {
  Options& options = arguments.run.run.options;
  OptionTable table = source_table(options.source);
  append(table, human_table(options.human));
  append(table, part_table(options.part));
  table.push_back(row("output", arguments.output, kOutputGroup, "FILE",
                      "Scene to write: .json or .obj; - writes JSON on standard output instead of "
                      "the table",
                      {.basic = true, .letter = "o"}));
  append(table, common_table(arguments.run.common));
  return table;
}

OptionTable compare_table(CompareArguments& arguments) {
  OptionTable table = {row("tolerance", arguments.tolerance, kGeneralGroup, "X",
                           "Maximum accepted difference, in the files' units",
                           {.min = 0.0, .max = 1e6, .basic = true}),
                       memory_row(arguments.memory_gb)};
  append(table, rows_for(OptionUse::kConvert, robot_table(arguments.robot)));
  append(table, reading_table(arguments.reading));
  append(table, common_table(arguments.common));
  return table;
}

OptionTable inspect_table(InspectArguments& arguments) {
  Options& options = arguments.run.run.options;
  OptionTable table = rows_for(OptionUse::kInspect, source_table(options.source));
  table.push_back(row("skeleton", arguments.skeleton_only, kInputGroup, "",
                      "Accept a BVH file without MOTION"));
  append(table, rows_for(OptionUse::kInspect, human_table(options.human)));
  table.push_back(write_map_row(arguments.run.request.write_map));
  table.push_back(row("json", arguments.json, kOutputGroup, "", "Print JSON on standard output",
                      {.basic = true}));
  table.push_back(row("html", arguments.html, kOutputGroup, "FILE",
                      "Write a page that plays the motion next to its rest pose, with the detected "
                      "properties; opens from disk",
                      {.basic = true}));
  table.push_back(row("positions", arguments.positions, kOutputGroup, "FILE",
                      "Write world positions and quaternions (xyzw) of all joints and end sites, "
                      "in the file's units and axes, as CSV; - writes standard output"));
  append(table, common_table(arguments.run.common));
  return table;
}

OptionTable view_table(ViewArguments& arguments) {
  OptionTable table = {
      row("label", arguments.labels, kOutputGroup, "TEXT",
          "Page: label of a motion, one per motion; repeatable (default: the file names)",
          {.basic = true}),
      row("meshes", arguments.meshes, kOutputGroup, "DIR|MODEL",
          "Page: draw these meshes instead of the collision primitives: STL and OBJ files named "
          "like the meshes or bodies of the robot's model, or the meshes of another model, MJCF or "
          "URDF (default: available meshes of the robot's model)"),
      row("fps", arguments.fps, kTimeGroup, "N|source",
          "Frame rate of motions whose files state none, and of the source of a page, in frames "
          "per second, or `source` (default: the rate of the first motion; files without one: 30, "
          "SOMA 120)"),
      gate_row(arguments.gates, std::string(kGateHelp) + ". Only for pages")};
  append(table, rows_for(OptionUse::kShow, run_command_table(arguments.run)));
  // As in evaluate, --source-fps is the rate of the source, if there is one.
  append(table, without_rows_of(table, reading_table(arguments.reading)));
  return table;
}

std::set<std::string> advanced_option_names() {
  RunArguments run;
  EvaluateArguments evaluate;
  InspectArguments inspect;
  ConvertArguments convert;
  CertifyArguments certify;
  SimulateArguments simulate;
  CompareArguments compare;
  ContactsArguments contacts;
  SceneFromMotionArguments scene;
  ViewArguments view;
  OptionTable all = run_command_table(run);
  append(all, evaluate_table(evaluate));
  append(all, inspect_table(inspect));
  append(all, convert_table(convert));
  append(all, certify_table(certify));
  append(all, simulate_table(simulate));
  append(all, compare_table(compare));
  append(all, contacts_table(contacts));
  append(all, scene_from_motion_table(scene));
  append(all, view_table(view));
  append(all, outer_option_table());
  std::set<std::string> names;
  for (const Option& each : all) names.insert(each.name);
  for (const Option& each : all) {
    if (each.info.basic) names.erase(each.name);
  }
  return names;
}

std::set<std::string> shared_option_names() {
  RunArguments run;
  OptionTable shared = source_table(run.run.options.source);
  append(shared, human_table(run.run.options.human));
  append(shared, common_table(run.common));
  shared.push_back(write_map_row(run.request.write_map));
  const std::vector<std::string> names = option_names(shared);
  return {names.begin(), names.end()};
}

}  // namespace retarget::cli
