// `retarget convert`: converts robot motions between formats.

#include <string>
#include <utility>

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/resample.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"
#include "shared_arguments.h"

namespace retarget::cli {
namespace {

// Returns true for a human motion: no robot options are given, and the only output is a GLB.
bool is_of_human(const ConvertRequest& request) {
  ConvertRequest copy = request;
  // Options for robots and their files.
  OptionTable rows = reading_table(copy.reading);
  append(rows, robot_table(copy.robot));
  ConvertRequest without_options;
  OptionTable defaults = reading_table(without_options.reading);
  append(defaults, robot_table(without_options.robot));
  if (!changed_options(rows, defaults).empty()) return false;
  // Only robots have references.
  if (request.save.reference_rate > 0.0 || !request.save.reference.empty()) return false;
  const auto items = plan_outputs(request.output, request.save);
  return items && items->size() == 1 && items->front().format == MotionFormat::kGlb;
}

Result<void> check_usage(const ConvertRequest& request, const CommonArguments& common) {
  if (!is_of_human(request)) RETARGET_TRY(check_robot_choice(request.robot));
  Run run;
  run.motion = request.input;
  run.robot = request.robot;
  run.options.save = request.save;
  run.output = request.output;
  return check_outputs(run, false, files_read(run, common), {});
}

Result<void> convert_human(const ConvertRequest& request, const CommonArguments& common,
                           Console& console) {
  SourceOptions source;
  source.memory_gb = request.memory_gb;
  auto read = load_clip(request.input, source);
  if (!read) {
    std::string& hint = read.error().hint;
    hint += (hint.empty() ? "" : "; ") + std::string("a robot motion needs --robot NAME");
    return failure(std::move(read).error());
  }
  Clip clip = *std::move(read);
  console.warn(clip.origin().warnings, clip.name());
  const TimeOptions& time = request.time;
  if (time.fps) {
    auto resampled = resample(std::move(clip), frame_rate_from_fps(*time.fps),
                              {time.interpolation, !time.no_antialias});
    if (!resampled) resampled.error().location.file = request.input;
    RETARGET_TRY_ASSIGN(clip, std::move(resampled));
  }
  const std::string summary =
      count_text(clip.frame_count(), "frame") + " at " + to_text(clip.rate()) + " fps";
  RETARGET_TRY(save_human_glb(request.output, std::move(clip), {}, common, console));
  console.line("wrote",
               (request.output == "-" ? "standard output" : request.output) + ": " + summary);
  return {};
}

}  // namespace

Result<void> convert(const ConvertArguments& arguments, Console& console) {
  ConvertRequest request = arguments.request;
  request.data_folder = DataFolder{arguments.common.data_dir};
  RETARGET_TRY(check_usage(request, arguments.common));
  if (is_of_human(request)) return convert_human(request, arguments.common, console);
  RETARGET_TRY(convert_motion(request, console));
  return {};
}

}  // namespace retarget::cli
