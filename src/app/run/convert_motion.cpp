// Converts robot motions between formats, and human motions to GLB.

#include <utility>

#include "app/plan/motion_target.h"
#include "base/option_name.h"
#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "retarget/plan.h"
#include "retarget/resample.h"
#include "retarget/robot.h"
#include "retarget/run.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Returns true for a human motion: no robot options are given, and the only output is a GLB.
bool is_of_human(const ConvertRequest& request) {
  // Options for robots and their files.
  const auto robot_rows = [](ConvertRequest& of) {
    OptionTable rows = reading_table(of.reading);
    append(rows, robot_table(of.robot));
    return rows;
  };
  ConvertRequest given = request, plain;
  if (!changed_options(robot_rows(given), robot_rows(plain)).empty()) return false;
  // Only robots have references.
  if (request.save.reference_rate > 0.0 || !request.save.reference.empty()) return false;
  const auto items = plan_outputs(request.output, request.save);
  return items && items->size() == 1 && items->front().format == MotionFormat::kGlb;
}

Result<void> check_files(const ConvertRequest& request) {
  Run run;
  run.motion = request.input;
  run.robot = request.robot;
  run.options.save = request.save;
  run.output = request.output;
  const std::string data_folder = find_data_folder(request.data_folder).value_or(std::string());
  return check_outputs(run, false, files_of(run, data_folder), {});
}

Result<std::vector<WrittenFile>> convert_human(const ConvertRequest& request, Observer& observer) {
  SourceOptions source;
  source.memory_gb = request.memory_gb;
  auto read = load_clip(request.input, source);
  if (!read) {
    std::string& hint = read.error().hint;
    hint +=
        (hint.empty() ? "" : "; ") + std::string("a robot motion needs " OPTION("robot") " NAME");
    return failure(std::move(read).error());
  }
  Clip clip = *std::move(read);
  observer.warn(clip.origin().warnings, clip.name());
  const TimeOptions& time = request.time;
  if (time.fps) {
    auto resampled = resample(std::move(clip), frame_rate_from_fps(*time.fps),
                              {time.interpolation, !time.no_antialias});
    if (!resampled) resampled.error().location.file = request.input;
    TRY_ASSIGN(clip, std::move(resampled));
  }
  const int frames = clip.frame_count();
  const FrameRate rate = clip.rate();
  const std::string summary = frames_text(frames, rate);
  TRY(write_human_glb(request.output, std::move(clip), {}, request.data_folder, observer));
  observer.line("wrote",
                (request.output == "-" ? "standard output" : request.output) + ": " + summary);
  return std::vector<WrittenFile>{{{MotionFormat::kGlb, request.output}, {}, {}, frames, rate}};
}

Result<std::vector<WrittenFile>> convert_robot(const ConvertRequest& request, Observer& observer) {
  // The file may contain joints that the variant locks, so read it as a motion of the whole robot.
  RobotChoice whole = request.robot;
  whole.variant.clear();
  TRY_ASSIGN(const LoadedRobot robot,
             load_robot(whole, request.data_folder, observer, Soles::kAsTheyAre));
  TRY_ASSIGN(
      RobotMotion motion,
      load_recorded_motion(request.input, robot.robot,
                           read_motion_options(request.reading, memory_share(request.memory_gb))));
  report_reading(request.input, motion, observer);
  const FrameRate file_rate = motion.clip.rate();
  RobotClip clip = std::move(motion.clip);
  if (!request.robot.variant.empty()) {
    TRY_ASSIGN(auto variant, robot_variant(robot.robot, request.robot.variant));
    if (const auto lost = lost_joints(clip, *variant)) {
      observer.warn({{0, 0, *lost}}, request.input);
    }
    clip = with_robot(clip, std::move(variant));
  }
  const TimeOptions& time = request.time;
  const FrameRate rate = time.fps ? frame_rate_from_fps(*time.fps) : file_rate;
  TRY(check_need({resampled_frame_count(clip.frame_count(), file_rate, rate), rate, motion.bytes,
                  request.input, false},
                 request.memory_gb, request.save));
  if (time.fps) {
    auto resampled = resample_robot(clip, rate, {time.interpolation, !time.no_antialias});
    if (!resampled) resampled.error().location.file = request.input;
    TRY_ASSIGN(clip, std::move(resampled));
  }
  if (motion.contacts) {
    motion.contacts = resample_contacts(*motion.contacts, file_rate, rate, clip.frame_count());
  }
  return write_motion(clip, motion.contacts, request.output, request.save, observer);
}

}  // namespace

Result<void> write_human_glb(const std::string& output, Clip clip, const HumanOptions& options,
                             const DataFolder& data_folder, Observer& observer) {
  TRY_ASSIGN(const std::string folder, find_data_folder(data_folder));
  TRY_ASSIGN(const HumanInClip human, find_human(clip, options, folder));
  observer.lines(human.lines());
  observer.warn(human.doubts(), clip.name());
  TRY_ASSIGN(const std::string bytes,
             format_human_glb(human_in_world(clip, human.calibration), name_of_motion(output)));
  return write_file(output, bytes);
}

Result<std::vector<WrittenFile>> convert_motion(const ConvertRequest& request, Observer& observer) {
  const bool of_human = is_of_human(request);
  if (!of_human) TRY(check_robot_choice(request.robot));
  TRY(check_files(request));
  return of_human ? convert_human(request, observer) : convert_robot(request, observer);
}

}  // namespace retarget
