// Any bytes as a BVH file, through the whole pipeline to a robot CSV and back.

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "fuzz/fuzz_target.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/limb_directions.h"
#include "human/skeleton/recognise.h"
#include "human/skeleton/skeleton_profile.h"
#include "retarget/clip_range.h"
#include "retarget/motion_io.h"
#include "retarget/resample.h"
#include "retarget/retargeting_config.h"
#include "solve/fit/fit.h"
#include "solve/targets/solve_frames.h"

namespace retarget::fuzz {
namespace {

// So small that a run takes much less than a second under sanitizers.
constexpr int kMaxJoints = 48;
constexpr int kMaxFrames = 6;

// The inputs of a run except for the motion.
struct Setup {
  std::vector<SkeletonProfile> profiles;
  ResolvedConfig of_lafan1, of_others;
  LimitSet limits;
  FitOptions fit;
};

template <typename Value>
Value take(Result<Value> result) {
  require(result.has_value(), "the repository's own files load");
  return std::move(*result);
}

const Setup& setup() {
  static const Setup made = [] {
    const std::string root(RETARGET_SOURCE_DIR);
    Setup setup;
    setup.profiles = take(load_skeleton_profiles(root + "/configs/skeletons"));
    setup.of_lafan1 = take(load_config(root + "/configs/lafan1_to_unitree_g1.json", *fuzz_robot()));
    setup.of_others = take(load_config(root + "/robots/unitree_g1/ik.json", *fuzz_robot()));
    setup.limits = take(load_limits(*fuzz_robot(), "official"));
    setup.fit.iterations = 2;
    setup.fit.anchor_iterations = 1;
    setup.fit.threads = 1;
    return setup;
  }();
  return made;
}

// The motion as read by the tool; nothing if it is rejected.
std::optional<Clip> short_clip(std::string_view bytes) {
  auto file = read_bvh(bytes, "fuzz.bvh");
  if (!good(file)) return std::nullopt;
  Clip clip = std::move(file->clip);
  const int frames = clip.frame_count();
  if (frames == 0 || clip.skeleton().joint_count() > kMaxJoints) return std::nullopt;
  const int first = count_lead_in_frames(clip);
  require(first >= 0 && first < frames, "a motion is left");
  return cut(std::move(clip), first, std::min(frames, first + kMaxFrames));
}

// Properties of every written motion.
void check_lines_of_motion(const RobotClip& clip) {
  const Robot& robot = *fuzz_robot();
  constexpr double kSlack = 1e-6;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    for (const double value : qpos) require(std::isfinite(value), "numbers are finite");
    for (std::size_t j = 0; j < robot.joints().size(); ++j) {
      const double value = qpos[static_cast<std::size_t>(robot.joints()[j].qpos_address)];
      require(
          value >= setup().limits.lower[j] - kSlack && value <= setup().limits.upper[j] + kSlack,
          "joints are inside their limits");
    }
  }
}

// A written motion is read back with the printed values.
void check_line_round_trip(const RobotClip& clip) {
  ReadMotionOptions options;
  options.rate = clip.rate();
  options.quaternion = QuaternionOrder::kXyzw;
  options.degrees = false;
  options.metres_per_unit = 1.0;
  const auto back = parse_robot_motion(format_robot_csv(clip), fuzz_robot(), "out.csv", options);
  require(back.has_value(), "the written text can be read");
  require(back->clip.frame_count() == clip.frame_count(), "frames come back");
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t i = 7; i < clip.qpos(frame).size(); ++i) {
      require(std::abs(clip.qpos(frame)[i] - back->clip.qpos(frame)[i]) < 1e-5, "joints come back");
    }
  }
}

}  // namespace

void fuzz_line(std::string_view bytes) {
  auto clip = short_clip(bytes);
  if (!clip) return;
  auto map = recognise_skeleton(*clip, setup().profiles);
  if (!good(map)) return;
  (void)let_directions_win(*clip, *map);
  const auto calibration = calibrate(*clip, *map, {});
  if (!good(calibration)) return;
  const auto resampled = resample(*clip, FrameRate{30, 1});
  if (!good(resampled) || resampled->frame_count() > kMaxFrames) return;
  const bool is_lafan1 = calibration->rest_pose == "lafan1";
  const ResolvedConfig& config = is_lafan1 ? setup().of_lafan1 : setup().of_others;
  FitRun run;
  run.retarget.scale = is_lafan1 ? ScaleRule::kTable : ScaleRule::kLimbs;
  const auto fitted =
      fit(*resampled, *calibration, fuzz_robot(), config, setup().limits, setup().fit, run);
  if (!good(fitted)) return;
  check_lines_of_motion(fitted->clip);
  check_line_round_trip(fitted->clip);
}

}  // namespace retarget::fuzz
