#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "edit/fit_path.h"
#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "edit/seam.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/option_name.h"
#include "retarget/pose.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// A path shorter than this defines no speed, metres.
constexpr double kMinPathLength = 0.01;

// Returns the playback rate on the new path that keeps the original travel speed.
Result<double> playing_speed(PathKeep keep, double own_length, double length) {
  if (keep != PathKeep::kSpeed) return 1.0;
  if (own_length < kMinPathLength || length < kMinPathLength) {
    return usage_failure(
        "a path of " + number_text(std::min(own_length, length), 3) + " m has no speed to keep",
        "keep the time instead");
  }
  return own_length / length;
}

// Returns the foot plants on the new path: each contact moves rigidly, as its middle frame does.
// `clip` and `human` are the source, played at `speed`; `moves` has one entry per original frame.
std::vector<PlantedFoot> moved_plants(const Clip& clip, const Calibration& calibration,
                                      const HumanClip& human, const std::vector<GroundPose>& moves,
                                      double speed) {
  std::vector<PlantedFoot> plants;
  const auto stands = find_foot_stands(human);
  const auto last_move = static_cast<double>(moves.size() - 1);
  const auto legs = find_legs(clip.skeleton(), calibration);
  for (int foot = 0; foot < 2; ++foot) {
    if (!legs[foot]) continue;
    const auto ankles = ankle_poses(clip, calibration, *legs[foot]);
    for (const FootStand& stand : stands[foot]) {
      const int middle = (stand.begin + stand.end) / 2;
      const double moved_as = std::min(std::round(speed * middle), last_move);
      const Pose move = moves[static_cast<std::size_t>(moved_as)].in_space();
      PlantedFoot plant = plant_of(stand, foot, middle, ankles, human);
      for (Pose& pose : plant.world_from_foot) pose = move * pose;
      plants.push_back(std::move(plant));
    }
  }
  return plants;
}

// @param beyond       metres that the motion travels beyond the end of the path.
// @param fits_stride  the original strides are not kept, and end before the path does.
std::vector<Warning> doubts_about(const FollowedPath& followed, double beyond, bool fits_stride) {
  constexpr double kNotedMiss = 0.005, kNotedCorrection = 0.15;
  std::vector<Warning> doubts = as_warnings(followed.check.faults);
  if (beyond >= kMinPathLength) {
    doubts.push_back({0, 0,
                      "the motion leaves the end of the path and goes straight on for " +
                          number_text(beyond, 2) +
                          " m: its own path is longer; use a longer path or " +
                          RETARGET_OPTION("keep") " time or speed"});
  }
  const PlantSummary& feet = followed.feet;
  if (feet.largest_miss > kNotedMiss) {
    doubts.push_back({0, 0,
                      "a leg is too short to reach its target position by " +
                          number_text(100.0 * feet.largest_miss, 1) + " cm"});
  }
  if (feet.largest_correction > kNotedCorrection) {
    doubts.push_back({0, 0,
                      "a standing foot was moved by " +
                          number_text(100.0 * feet.largest_correction, 0) +
                          " cm: the new path turns or accelerates where the steps do not; use a "
                          "gentler path" +
                          (fits_stride ? " or " RETARGET_OPTION("keep") " stride" : "")});
  }
  return doubts;
}

}  // namespace

Result<FollowedPath> follow_path(const Clip& clip, const Calibration& calibration,
                                 const GroundPath& path, const FollowPathOptions& options) {
  RETARGET_TRY_ASSIGN(const auto mover, BodyMover::of(clip, calibration));
  const HumanClip human = to_human(clip, calibration);
  RETARGET_TRY_ASSIGN(auto own, fit_path(human, options.fit));
  RETARGET_TRY_ASSIGN(const double speed,
                      playing_speed(options.keep, own.path.length(), path.length()));

  // Headings while standing: the original path turns as the body does, the new one as the original
  // path does.
  std::vector<double> body_turns, own_turns;
  for (const StillPhase& phase : own.still) body_turns.push_back(phase.turn);
  auto own_frames = path_frames(own.path, own.along, own.still, body_turns);
  spread_turns(own_frames, clip.rate());
  const auto last = static_cast<int>(own_frames.size()) - 1;
  for (const StillPhase& phase : own.still) {
    own_turns.push_back(own_frames[std::min(phase.end, last)].heading -
                        own_frames[std::max(phase.begin - 1, 0)].heading);
  }
  const double stretch =
      options.keep == PathKeep::kStride ? 1.0 : path.length() / own.path.length();
  std::vector<double> along;
  for (const double place : own.along) along.push_back(stretch * place);

  FollowedPath result{{clip}, std::move(own), {}, {}, {}};
  result.frames = path_frames(path, along, result.source.still, own_turns);
  spread_turns(result.frames, clip.rate());
  std::vector<GroundPose> moves;
  for (std::size_t frame = 0; frame < own_frames.size(); ++frame) {
    moves.push_back(result.frames[frame] * own_frames[frame].inverse());
    mover.move(result.clip, static_cast<int>(frame), moves.back());
  }
  // Plant the feet last, in the resampled clip, because a filter would move them.
  std::vector<PlantedFoot> plants;
  if (speed == 1.0) {
    plants = moved_plants(clip, calibration, human, moves, 1.0);
  } else {
    RETARGET_TRY_ASSIGN(const auto played, change_timing(clip, {.speed = speed}));
    RETARGET_TRY_ASSIGN(result.clip, change_timing(std::move(result.clip), {.speed = speed}));
    plants = moved_plants(played, calibration, to_human(played, calibration), moves, speed);
  }
  RETARGET_TRY_ASSIGN(result.feet, plant_feet(result.clip, calibration, plants));
  result.check = check_motion(human, human, to_human(result.clip, calibration),
                              {0, result.clip.frame_count(), 0, 0, 0}, options.limits);
  const double way = stretch * result.source.path.length(), beyond = way - path.length();
  result.notes = {
      {"new path",
       path_text(path) +
           (std::abs(beyond) < kMinPathLength ? "" : ", travel " + number_text(way, 3) + " m") +
           ", " + number_text(result.clip.duration(), 3) + " s"},
      {"feet", planted_text(result.feet)}};
  const bool fits_stride = options.keep != PathKeep::kStride &&
                           result.source.path.length() < path.length() + kMinPathLength;
  result.doubts = doubts_about(result, beyond, fits_stride);
  return result;
}

}  // namespace retarget
