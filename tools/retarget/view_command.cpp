// `retarget view`: makes a page that plays robot motions, or a picture of one.

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "measure_files.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/file.h"
#include "retarget/file_endings.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/measure_files.h"
#include "retarget/motion_io.h"
#include "retarget/motion_scene.h"
#include "retarget/option_name.h"
#include "retarget/options.h"
#include "retarget/plan.h"
#include "retarget/run.h"
#include "retarget/solve.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "retarget/view.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

bool is_page(const std::string& output) {
  const std::string ending = lower_case(fs::path(output).extension().string());
  return ending == ".html" || ending == ".htm";
}

// Rejects options that do not apply to the chosen output, page or picture.
Result<void> check_use(const ViewArguments& arguments) {
  const bool page = is_page(arguments.run.run.output);
  if (page && arguments.run.png.empty() && arguments.run.strip > 0) {
    return usage_failure("--strip needs a PNG or SVG output, but only a page is written",
                         "add --png FILE, or give an output that ends in .png or .svg");
  }
  if (!page &&
      (!arguments.labels.empty() || !arguments.meshes.empty() || !arguments.gates.empty())) {
    return usage_failure(std::string(!arguments.labels.empty()   ? "--label"
                                     : !arguments.meshes.empty() ? "--meshes"
                                                                 : "--gate") +
                             " needs a page, but only a strip of poses is written",
                         "give an output that ends in .html");
  }
  return {};
}

Result<void> check_usage(const ViewArguments& arguments) {
  const Run& run = arguments.run.run;
  RETARGET_TRY(check_robot_choice(run.robot));
  RETARGET_TRY(check_use(arguments));
  RETARGET_TRY_ASSIGN(const auto read, check_inputs(arguments));
  if ((!is_page(run.output) || !arguments.run.png.empty()) && arguments.motions.size() > 1) {
    return usage_failure("a strip of poses shows one motion, found " +
                             count_text(arguments.motions.size(), "motion"),
                         "give an output that ends in .html to play them side by side");
  }
  if (!arguments.labels.empty() && arguments.labels.size() != arguments.motions.size()) {
    return usage_failure(count_text(arguments.labels.size(), "label") + " and " +
                             count_text(arguments.motions.size(), "motion") + " are given",
                         "give one --label per motion, in the same order");
  }
  RETARGET_TRY(
      check_written({run.output, arguments.run.png, arguments.run.request.write_map}, read));
  RETARGET_TRY(check_output_ending(arguments.run.png, {".png"}, "a picture in the format PNG"));
  return check_output_ending(run.output, {".html", ".htm", ".png", ".svg"}, "a page or a picture");
}

// Draws a strip in the format that the file name implies.
std::string strip_bytes(const std::string& file, const ViewArguments& arguments,
                        const RobotMotion& motion, const HumanClip* human) {
  if (file == arguments.run.png || lower_case(fs::path(file).extension().string()) == ".png") {
    StripPictureOptions options;
    options.poses = arguments.run.strip;
    return draw_strip_picture(motion.clip, human, options);
  }
  const std::string name = fs::path(arguments.motions.front()).filename().string();
  return draw_strip(motion.clip, human,
                    {arguments.run.strip, name + ", " + motion.clip.robot().name()});
}

// Returns the human source of a motion, resampled to the motion's frames.
Result<std::optional<HumanClip>> source_human(RunArguments arguments, const LoadedRobot& robot,
                                              const FrameRate& rate, Console& console) {
  Run& run = arguments.run;
  if (run.motion.empty()) return std::optional<HumanClip>();
  run.options.time.fps = rate.fps();
  RETARGET_TRY_ASSIGN(const RobotSetup setup, retarget::set_up_robot(robot, run.options));
  RETARGET_TRY_ASSIGN(const Plan plan, read_and_plan(run, arguments.request, setup, console));
  RETARGET_TRY_ASSIGN(const auto clip, prepare_clip(plan));
  return std::optional(to_human(*clip, plan.human.calibration));
}

// The rate of the source is not that of the motion.
Result<ReadMotionOptions> reading_of(const ViewArguments& arguments) {
  const Run& run = arguments.run.run;
  ReadMotionOptions reading =
      read_motion_options(arguments.reading, memory_share(run.options.source.memory_gb));
  const double fps = run.options.source.source_fps;
  if (run.motion.empty() && fps > 0.0) reading.rate = frame_rate_from_fps(fps);
  if (!arguments.fps.empty()) {
    RETARGET_TRY_ASSIGN(const auto rate, rate_of(arguments.fps));
    if (rate) reading.default_rate = frame_rate_from_fps(*rate);
  }
  return reading;
}

Result<void> draw_picture(const ViewArguments& arguments, Console& console) {
  const Run& run = arguments.run.run;
  const std::string& file = arguments.motions.front();
  RETARGET_TRY_ASSIGN(const LoadedRobot robot,
                      load_robot(run.robot, arguments.run.common, console, Soles::kAsTheyAre));
  RETARGET_TRY_ASSIGN(const ReadMotionOptions reading, reading_of(arguments));
  RETARGET_TRY_ASSIGN(RobotMotion motion, load_recorded_motion(file, robot.robot, reading));
  motion.rate_known = motion.rate_known || reading.default_rate.has_value();
  report_reading(file, motion, console, RETARGET_OPTION("fps"));
  RETARGET_TRY_ASSIGN(const auto human,
                      source_human(arguments.run, robot, motion.clip.rate(), console));
  for (const std::string& output : {run.output, arguments.run.png}) {
    if (output.empty() || is_page(output)) continue;
    RETARGET_TRY(
        write_file(output, strip_bytes(output, arguments, motion, human ? &*human : nullptr)));
    console.line("wrote",
                 output + ": " +
                     count_text(std::min(arguments.run.strip, motion.clip.frame_count()), "pose"));
  }
  return {};
}

using Scenes = std::vector<std::shared_ptr<const MotionScene>>;

// The scenes of motions; null: none. Motions that show the same human share one.
Result<Scenes> scenes_of(const std::vector<MeasuredMotion>& motions, const Measures& measures,
                         Console& console) {
  Scenes scenes;
  for (const MeasuredMotion& motion : motions) {
    const auto same = std::ranges::find_if(motions, [&](const MeasuredMotion& other) {
      return other.human != nullptr && other.human == motion.human;
    });
    const auto known = static_cast<std::size_t>(same - motions.begin());
    if (known < scenes.size()) {
      scenes.push_back(scenes[known]);
      continue;
    }
    RETARGET_TRY_ASSIGN(auto scene, measured_scene(motion, measures));
    if (scene) console.lines(scene_lines(&scene->robot));
    scenes.push_back(std::move(scene));
  }
  return scenes;
}

// Labels that distinguish the files: by name, or by folder and name if names coincide.
std::vector<std::string> labels_of(const ViewArguments& arguments) {
  if (!arguments.labels.empty()) return arguments.labels;
  std::vector<std::string> labels;
  for (const std::string& file : arguments.motions) {
    const fs::path path(file);
    const auto same_name = [&](const std::string& other) {
      return fs::path(other).filename() == path.filename();
    };
    const bool alone = std::ranges::count_if(arguments.motions, same_name) == 1;
    labels.push_back(file == "-" ? "standard input"
                                 : (alone ? path.filename() : path.lexically_normal()).string());
  }
  return labels;
}

Result<void> write_page(const ViewArguments& arguments, Console& console) {
  const std::string& output = arguments.run.run.output;
  RETARGET_TRY_ASSIGN(const MeasureRequest request, measure_request(arguments));
  RETARGET_TRY_ASSIGN(const Measures measures, load_measures(request, console));
  std::vector<MeasuredMotion> motions;
  for (const std::string& file : arguments.motions) {
    RETARGET_TRY_ASSIGN(MeasuredMotion motion, measure_file(file, measures, console));
    motions.push_back(std::move(motion));
  }
  const std::vector<std::string> labels = labels_of(arguments);
  RETARGET_TRY_ASSIGN(const RobotMeshes meshes,
                      load_robot_meshes(*measures.robot, measures.model, arguments.meshes));
  console.lines(mesh_lines(meshes));
  RETARGET_TRY_ASSIGN(const Scenes scenes, scenes_of(motions, measures, console));
  std::vector<PageMotion> shown;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    shown.push_back({labels[i], &motions[i].clip, motions[i].human, &motions[i].report,
                     &measures.limits, motions[i].file_rate, &meshes, scenes[i].get()});
  }
  RETARGET_TRY_ASSIGN(const std::string page, view_page(shown));
  RETARGET_TRY(write_file(output, page));
  console.line("wrote", output + ": " + count_text(motions.size(), "motion") + ", " +
                            number_text(static_cast<double>(page.size()) / 1e6, 2) +
                            " MB (open it in a browser)");
  return {};
}

}  // namespace

Result<void> view(const ViewArguments& given, Console& console) {
  ViewArguments arguments = given;
  std::error_code ignored;
  const auto is_batch = [&](const std::string& path) {
    return fs::is_directory(path, ignored) && !is_sonic_folder(path);
  };
  if (std::ranges::any_of(arguments.motions, is_batch)) {
    return view_gallery(arguments, console);
  }
  RETARGET_TRY(take_smpl_file(arguments.run));
  RETARGET_TRY(check_usage(arguments));
  if (arguments.run.strip == 0) arguments.run.strip = StripPictureOptions().poses;
  const bool page = is_page(arguments.run.run.output);
  if (!page || !arguments.run.png.empty()) RETARGET_TRY(draw_picture(arguments, console));
  return page ? write_page(arguments, console) : Result<void>();
}

}  // namespace retarget::cli
