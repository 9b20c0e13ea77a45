#include "declare.h"
#include "declare_shared.h"

namespace retarget::cli {
namespace {

void add_output_options(CLI::App& command, EditOptions& options) {
  command.add_option("-o,--output", options.output, "BVH to write; - writes standard output")
      ->required()
      ->type_name("FILE")
      ->group(kOutput);
  add_common_options(command, options.common);
}

void add_part_options(CLI::App& command, PartOptions& part) {
  command.add_option("--start", part.start_s, "Begin at this time of the source, seconds")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kInput);
  command.add_option("--end", part.end_s, "End at this time of the source, seconds, inclusive")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kInput);
  command
      .add_option("--frames", part.frames,
                  "Source frames from A up to, not including, B; either may be left out")
      ->type_name("A:B")
      ->group(kInput);
}

// one kind of edit: `retarget edit NAME IN ... -o OUT`
CLI::App* start_edit(CLI::App& edits, EditOptions& options, Edit edit, const char* name,
                     const char* description) {
  CLI::App* command = edits.add_subcommand(name, description);
  command->parse_complete_callback([&options, edit] { options.edit = edit; });
  command->add_option("file", options.source.file, "Motion to edit, BVH; - reads standard input")
      ->required()
      ->type_name("FILE");
  return command;
}

void add_skeleton_edit(CLI::App& edits, EditOptions& options, Edit edit, const char* name,
                       const char* description, const char* like_option) {
  CLI::App* command = start_edit(edits, options, edit, name, description);
  if (like_option[0] != '\0') {
    command->add_option(like_option, options.like, "BVH of the skeleton that is wanted")
        ->required()
        ->type_name("FILE")
        ->group(kInput);
  }
  add_source_options(*command, options.source);
  if (edit != Edit::kRest) add_human_options(*command, options.human);
  add_output_options(*command, options);
}

// what all edits of a clip's own skeleton take beside their own options
void finish_edit(CLI::App& command, EditOptions& options, bool human) {
  add_part_options(command, options.part);
  add_source_options(command, options.source);
  if (human) add_human_options(command, options.human);
  add_output_options(command, options);
}

void add_seam_limits(CLI::App& command, double& threshold_cm, bool& force) {
  command.add_option("--threshold", threshold_cm, "Largest distance of a seam, cm")
      ->type_name("CM")
      ->check(number_from(0.0, 1e6))
      ->capture_default_str()
      ->group(kTime);
  command.add_flag("--force", force, "Join what does not fit, too")->group(kTime);
}

void add_resample(CLI::App& edits, EditOptions& options) {
  CLI::App* command = start_edit(edits, options, Edit::kResample, "resample",
                                 "Another frame rate, or faster or slower");
  TimingOptions& timing = options.timing;
  command
      ->add_option("--fps", timing.fps, "Frames per second of the output (default: the source's)")
      ->type_name("N")
      ->group(kTime);
  command
      ->add_option("--speed", timing.speed, "How many times as fast: 0.8 takes 1/0.8 of the time")
      ->type_name("N")
      ->check(number_from(0.01, 100.0))
      ->group(kTime);
  command->add_option("--interpolation", timing.interpolation, "Between source frames")
      ->type_name("linear|cubic")
      ->check(silent(CLI::IsMember({"linear", "cubic"})))
      ->capture_default_str()
      ->group(kTime);
  command
      ->add_flag("--no-antialias", timing.no_antialias,
                 "Do not low-pass a source that is faster than the output")
      ->group(kTime);
  finish_edit(*command, options, false);
}

void add_loop(CLI::App& edits, EditOptions& options) {
  CLI::App* command = start_edit(edits, options, Edit::kLoop, "loop",
                                 "A cycle from the first frame to the one most like it");
  CycleOptions& cycle = options.cycle;
  command
      ->add_option("--shortest", cycle.shortest_s,
                   "The cycle lasts so long or longer, seconds\n(default: half the clip)")
      ->type_name("S")
      ->check(number_from(0.0, kLongestTime))
      ->group(kTime);
  command->add_option("--times", cycle.times, "How often the cycle is played")
      ->type_name("N")
      ->capture_default_str()
      ->group(kTime);
  command->add_flag("--in-place", cycle.in_place, "The body neither advances nor turns")
      ->group(kTime);
  add_seam_limits(*command, cycle.threshold_cm, cycle.force);
  finish_edit(*command, options, true);
}

void add_placing_edits(CLI::App& edits, EditOptions& options) {
  CLI::App* command = start_edit(edits, options, Edit::kMirror, "mirror",
                                 "The mirror image: left does what right did");
  finish_edit(*command, options, true);
  command = start_edit(edits, options, Edit::kGround, "ground",
                       "Raise or lower the motion so that the floor is at height 0");
  command
      ->add_option("--floor", options.floor,
                   "Height of the floor in the source, metres\n(default: where the feet stand)")
      ->type_name("H")
      ->check(number_from(-1e6, 1e6))
      ->group(kInput);
  finish_edit(*command, options, true);
  command = start_edit(edits, options, Edit::kTurn, "turn",
                       "Turn the motion about the vertical, where it begins");
  command->add_option("degrees", options.amount, "Angle; positive to the left")
      ->required()
      ->type_name("DEG")
      ->check(number_from(-1e6, 1e6));
  finish_edit(*command, options, true);
  command = start_edit(edits, options, Edit::kMove, "move",
                       "Move the motion over the ground (docs/editing.md: its axes)");
  command->add_option("shift", options.amount, "Along x and y, metres")
      ->required()
      ->type_name("X,Y");
  finish_edit(*command, options, true);
}

void add_concat(CLI::App& edits, EditOptions& options) {
  SeamCliOptions& concat = options.concat;
  CLI::App* command =
      edits.add_subcommand("concat", "Join clips where they fit best; the first one's skeleton");
  command->parse_complete_callback([&options] { options.edit = Edit::kConcat; });
  command->add_option("files", concat.files, "Motions in their order, BVH")
      ->required()
      ->type_name("FILE...");
  command
      ->add_option("--search", concat.search,
                   "Where the seam is looked for: so many seconds at the end of\nthe one and the "
                   "beginning of the other, or `all`\n(default: 2, and more while no seam is good)")
      ->type_name("S|all")
      ->group(kTime);
  command
      ->add_option("--window", concat.window_s,
                   "Of the frames that are compared and blended, seconds\n(default: a third)")
      ->type_name("S")
      ->check(number_from(0.0, 10.0))
      ->group(kTime);
  command
      ->add_option("--blend", concat.blend,
                   "Mix the frames that both have, or let the difference fade in\nthe second")
      ->type_name("crossfade|inertial")
      ->check(silent(CLI::IsMember({"crossfade", "inertial"})))
      ->capture_default_str()
      ->group(kTime);
  add_seam_limits(*command, concat.threshold_cm, concat.force);
  command
      ->add_option("--matrix", concat.matrix,
                   "Write the distances that were searched as a picture, PGM\n(of several seams: "
                   "the first)")
      ->type_name("FILE")
      ->group(kOutput);
  add_source_options(*command, options.source);
  add_human_options(*command, options.human);
  add_output_options(*command, options);
}

void add_path_options(CLI::App& command, PathCliOptions& path) {
  command.add_option("--fit", path.fit, "Write the motion's own path, JSON, to be edited")
      ->type_name("FILE")
      ->group(kOutput);
  command.add_option("--svg", path.svg, "Draw the paths and the feet, seen from above")
      ->type_name("FILE")
      ->group(kOutput);
  command
      .add_option("--to", path.to,
                  "Path to follow: JSON, or one that is ready, as long as the\nmotion's own and "
                  "where it begins (default: its own)")
      ->type_name("FILE|line|circle|figure8")
      ->group(kTime);
  command.add_option("--radius", path.radius, "Of --to circle, metres; to the right when negative")
      ->type_name("M")
      ->check(number_from(-1e6, 1e6))
      ->capture_default_str()
      ->group(kTime);
  command.add_option("--scale", path.scale, "Make the path larger or smaller, from its beginning")
      ->type_name("N")
      ->check(number_from(0.001, 1000.0))
      ->capture_default_str()
      ->group(kTime);
  command
      .add_option("--rotate", path.rotate_deg,
                  "Turn the path about its beginning, degrees to the left")
      ->type_name("DEG")
      ->check(number_from(-1e6, 1e6))
      ->capture_default_str()
      ->group(kTime);
  command
      .add_option("--keep", path.keep,
                  "On a longer or shorter path: the duration (longer strides),\nthe speed over "
                  "the ground (slower motion), or the strides\n(the motion ends where its own "
                  "way would)")
      ->type_name("time|speed|stride")
      ->check(silent(CLI::IsMember({"time", "speed", "stride"})))
      ->capture_default_str()
      ->group(kTime);
  command
      .add_option("--tolerance", path.tolerance,
                  "How far the fitted path may be from the track, metres")
      ->type_name("M")
      ->check(number_from(0.001, 100.0))
      ->capture_default_str()
      ->group(kTime);
}

}  // namespace

CLI::App* add_edit_command(CLI::App& app, EditOptions& options) {
  CLI::App* command = app.add_subcommand("edit", "Change a motion: BVH in, BVH out");
  command->require_subcommand(1);
  add_skeleton_edit(*command, options, Edit::kRest, "rest",
                    "The same movement on a skeleton of the same joints with another rest pose",
                    "--like");
  add_skeleton_edit(*command, options, Edit::kTransfer, "transfer",
                    "Another skeleton, moved through the T-pose", "--to");
  add_skeleton_edit(*command, options, Edit::kLafan1, "lafan", "A clip in the shape of LAFAN1", "");
  add_resample(*command, options);
  finish_edit(*start_edit(*command, options, Edit::kTrim, "trim", "A part of the clip"), options,
              false);
  add_placing_edits(*command, options);
  add_loop(*command, options);
  add_concat(*command, options);
  CLI::App* path = start_edit(*command, options, Edit::kPath, "path",
                              "The way over the ground: fit it, draw it, follow another");
  add_path_options(*path, options.path);
  finish_edit(*path, options, true);
  path->get_option("--output")->required(false);
  return command;
}

}  // namespace retarget::cli
