#include <type_traits>

#include "argument_tables.h"
#include "declare.h"
#include "declare_table.h"
#include "options/run_tables.h"

namespace retarget::cli {
namespace {

// one kind of edit: `retarget edit NAME IN ... -o OUT`
class EditCommand {
 public:
  EditCommand(CLI::App& edits, EditArguments& arguments, Edit edit, const char* name,
              const char* help)
      : app_(*edits.add_subcommand(name, help)), arguments_(arguments), edit_(edit) {
    app_.parse_complete_callback([&arguments, edit] { arguments.edit = edit; });
    if (edit == Edit::kConcat) {
      option("files", arguments.files, "FILE...", "Motions in their order, BVH", "")->required();
    } else {
      option("file", arguments.file, "FILE", "Motion to edit, BVH; - reads standard input", "")
          ->required();
    }
  }

  template <typename Value>
  CLI::Option* option(const char* name, Value& value, const char* type, const char* help,
                      const char* group = kTimeGroup) {
    CLI::Option* declared = app_.add_option(name, value, help)->type_name(type);
    if (group[0] != '\0') declared->group(group);
    const bool tells_default = std::string_view(help).find("default:") != std::string_view::npos;
    if (std::is_arithmetic_v<Value> && !tells_default) declared->capture_default_str();
    return declared;
  }

  template <typename Value>
  CLI::Option* number(const char* name, Value& value, const char* type, double least, double most,
                      const char* help, const char* group = kTimeGroup) {
    return option(name, value, type, help, group)->check(number_from(least, most));
  }

  template <typename Value>
  void choice(const char* name, Value& value, std::vector<std::pair<std::string, Value>> choices,
              const char* help) {
    std::vector<std::string> words;
    std::string now;
    for (const auto& [word, meaning] : choices) {
      words.push_back(word);
      if (meaning == value) now = word;
    }
    const auto choose = [&value, choices](const std::string& text) {
      for (const auto& [word, meaning] : choices) value = word == text ? meaning : value;
    };
    app_.add_option_function<std::string>(name, choose, help)
        ->type_name(CLI::detail::join(words, "|"))
        ->check(silent(CLI::IsMember(words)))
        ->default_str(now)
        ->group(kTimeGroup);
  }

  void flag(const char* name, bool& value, bool meaning, const char* help) {
    const auto set = [&value, meaning] { value = meaning; };
    app_.add_flag_callback(name, set, help)->group(kTimeGroup);
  }

  void seam_limits(double& threshold) {
    const auto set = [&threshold](double cm) { threshold = 0.01 * cm; };
    app_.add_option_function<double>("--threshold", set, "Largest distance of a seam, cm")
        ->type_name("CM")
        ->check(number_from(0.0, 1e6))
        ->default_str("20")
        ->group(kTimeGroup);
    flag("--force", arguments_.force, true, "Join what does not fit, too");
  }

  // what edits take beside their own options
  void finish() {
    const bool body = edit_ != Edit::kRest && edit_ != Edit::kResample && edit_ != Edit::kTrim;
    if (edit_ >= Edit::kResample && edit_ != Edit::kConcat) {
      number("--start", arguments_.part.start, "S", 0.0, kLongestTime,
             "Begin at this time of the source, seconds", kInputGroup);
      number("--end", arguments_.part.end, "S", 0.0, kLongestTime,
             "End at this time of the source, seconds, inclusive", kInputGroup);
      option("--frames", arguments_.part.frames, "A:B",
             "Source frames from A up to, not including, B; either may be left out", kInputGroup);
    }
    declare(app_, without(source_table(arguments_.source), {"smpl-model"}));
    if (body) {
      declare(app_, human_table(arguments_.human));
      declare(app_, {write_map_row(arguments_.write_map)});
    }
    option("-o,--output", arguments_.output, "FILE", "BVH to write; - writes standard output",
           kOutputGroup)
        ->required(edit_ != Edit::kPath);
    declare(app_, common_table(arguments_.common));
  }

 private:
  CLI::App& app_;
  EditArguments& arguments_;
  const Edit edit_;
};

void add_skeleton_edits(CLI::App& edits, EditArguments& arguments) {
  const char* of_like = "BVH of the skeleton that is wanted";
  EditCommand rest(edits, arguments, Edit::kRest, "rest",
                   "The same movement on a skeleton of the same joints with another rest pose");
  rest.option("--like", arguments.like, "FILE", of_like, kInputGroup)->required();
  rest.finish();
  EditCommand transfer(edits, arguments, Edit::kTransfer, "transfer",
                       "Another skeleton, moved through the T-pose");
  transfer.option("--to", arguments.like, "FILE", of_like, kInputGroup)->required();
  transfer.finish();
  EditCommand(edits, arguments, Edit::kLafan1, "lafan", "A clip in the shape of LAFAN1").finish();
}

void add_timing_edits(CLI::App& edits, EditArguments& arguments) {
  EditCommand resample(edits, arguments, Edit::kResample, "resample",
                       "Another frame rate, or faster or slower");
  resample.option("--fps", arguments.fps, "N",
                  "Frames per second of the output (default: the source's)");
  resample.number("--speed", arguments.timing.speed, "N", 0.01, 100.0,
                  "How many times as fast: 0.8 takes 1/0.8 of the time");
  resample.choice("--interpolation", arguments.timing.linear, {{"linear", true}, {"cubic", false}},
                  "Between source frames");
  resample.flag("--no-antialias", arguments.timing.antialias, false,
                "Do not low-pass a source that is faster than the output");
  resample.finish();
  EditCommand(edits, arguments, Edit::kTrim, "trim", "A part of the clip").finish();
}

void add_placing_edits(CLI::App& edits, EditArguments& arguments) {
  EditCommand(edits, arguments, Edit::kMirror, "mirror",
              "The mirror image: left does what right did")
      .finish();
  EditCommand ground(edits, arguments, Edit::kGround, "ground",
                     "Raise or lower the motion so that the floor is at height 0");
  ground.number("--floor", arguments.floor, "H", -1e6, 1e6,
                "Height of the floor in the source, metres\n(default: where the feet stand)",
                kInputGroup);
  ground.finish();
  EditCommand turn(edits, arguments, Edit::kTurn, "turn",
                   "Turn the motion about the vertical, where it begins");
  turn.number("degrees", arguments.degrees, "DEG", -1e6, 1e6, "Angle; positive to the left", "")
      ->default_str("")
      ->required();
  turn.finish();
  EditCommand move(edits, arguments, Edit::kMove, "move",
                   "Move the motion over the ground (docs/editing.md: its axes)");
  move.option("shift", arguments.shift, "X,Y", "Along x and y, metres", "")->required();
  move.finish();
}

void add_seam_edits(CLI::App& edits, EditArguments& arguments) {
  EditCommand loop(edits, arguments, Edit::kLoop, "loop",
                   "A cycle from the first frame to the one most like it");
  loop.number("--shortest", arguments.loop.shortest, "S", 0.0, kLongestTime,
              "The cycle lasts so long or longer, seconds\n(default: half the clip)");
  loop.option("--times", arguments.loop.times, "N", "How often the cycle is played");
  loop.flag("--in-place", arguments.loop.in_place, true, "The body neither advances nor turns");
  loop.seam_limits(arguments.loop.seam.threshold);
  loop.finish();
  EditCommand concat(edits, arguments, Edit::kConcat, "concat",
                     "Join clips where they fit best; the first one's skeleton");
  concat.option("--search", arguments.search, "S|all",
                "Where the seam is looked for: so many seconds at the end of\nthe one and the "
                "beginning of the other, or `all`\n(default: 2, and more while no seam is good)");
  concat.number("--window", arguments.concat.seam.window, "S", 0.0, 10.0,
                "Of the frames that are compared and blended, seconds\n(default: a third)");
  concat.choice("--blend", arguments.concat.blend,
                {{"crossfade", SeamBlend::kCrossfade}, {"inertial", SeamBlend::kInertial}},
                "Mix the frames that both have, or let the difference fade in\nthe second");
  concat.seam_limits(arguments.concat.threshold);
  concat.option("--matrix", arguments.matrix, "FILE",
                "Write the distances that were searched as a picture, PGM\n(of several seams: the "
                "first)",
                kOutputGroup);
  concat.finish();
}

void add_path(CLI::App& edits, EditArguments& arguments) {
  EditCommand path(edits, arguments, Edit::kPath, "path",
                   "The way over the ground: fit it, draw it, follow another");
  path.option("--fit", arguments.fit, "FILE", "Write the motion's own path, JSON, to be edited",
              kOutputGroup);
  path.option("--svg", arguments.svg, "FILE", "Draw the paths and the feet, seen from above",
              kOutputGroup);
  path.option("--to", arguments.path.to, "FILE|line|circle|figure8",
              "Path to follow: JSON, or one that is ready, as long as the\nmotion's own and "
              "where it begins (default: its own)");
  path.number("--radius", arguments.path.radius, "M", -1e6, 1e6,
              "Of --to circle, metres; to the right when negative");
  path.number("--scale", arguments.path.scale, "N", 0.001, 1000.0,
              "Make the path larger or smaller, from its beginning");
  path.number("--rotate", arguments.path.degrees, "DEG", -1e6, 1e6,
              "Turn the path about its beginning, degrees to the left");
  path.choice(
      "--keep", arguments.rethread.keep,
      {{"time", PathKeep::kTime}, {"speed", PathKeep::kSpeed}, {"stride", PathKeep::kStride}},
      "On a longer or shorter path: the duration (longer strides),\nthe speed over "
      "the ground (slower motion), or the strides\n(the motion ends where its own "
      "way would)");
  path.number("--tolerance", arguments.rethread.fit.tolerance, "M", 0.001, 100.0,
              "How far the fitted path may be from the track, metres");
  path.finish();
}

}  // namespace

CLI::App* add_edit_command(CLI::App& app, EditArguments& arguments) {
  CLI::App* command = app.add_subcommand("edit", "Change a motion: BVH in, BVH out");
  command->require_subcommand(1);
  add_skeleton_edits(*command, arguments);
  add_timing_edits(*command, arguments);
  add_placing_edits(*command, arguments);
  add_seam_edits(*command, arguments);
  add_path(*command, arguments);
  return command;
}

}  // namespace retarget::cli
