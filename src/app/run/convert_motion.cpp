// Converts robot motions between formats.

#include <utility>

#include "base/try.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/option_table.h"
#include "retarget/resample.h"
#include "retarget/robot.h"
#include "retarget/run.h"

namespace retarget {

Result<std::vector<WrittenFile>> convert_motion(const ConvertRequest& request, Observer& observer) {
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

}  // namespace retarget
