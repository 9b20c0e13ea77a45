#include "app/plan/clean_source.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "app/plan/scene_fit.h"
#include "app/plan/set_up_robot.h"
#include "base/option_name.h"
#include "base/try.h"
#include "human/gait/centred_root.h"
#include "human/gait/floor_tilt.h"
#include "human/gait/repeated_frames.h"
#include "human/gait/source_jumps.h"
#include "human/gait/standing_balance.h"
#include "human/gait/track_faults.h"
#include "human/gait/travel.h"
#include "human/skeleton/robot_human.h"
#include "motion/lost_end.h"
#include "retarget/clip_range.h"
#include "retarget/inspect.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/text.h"
#include "solve/fit/fit_setup.h"
#include "solve/fit/foot_plan.h"
#include "solve/targets/limb_lengths.h"

namespace retarget {
namespace {

// The published method does not clean clips, and robots' motions have no noise.
bool may_clean(const Clip& clip, const Options& options) {
  return options.human.clean == CleanRule::kAuto && options.solve.method != Method::kGmr &&
         !is_of_robot(clip);
}

// Raises the contact thresholds above the remaining noise of standing feet. Height thresholds grow
// in proportion to the speed threshold.
void look_above_noise(double foot_speed, FitOptions& fit) {
  constexpr double kFastest = 0.45, kRelease = 5.0 / 3.0;
  constexpr double kHigher = 0.02, kReleaseHigher = 0.03;  // Metres, at kFastest.
  const double speed = std::min(foot_speed, kFastest);
  if (!(speed > fit.contact_speed)) return;
  const double share = (speed - fit.contact_speed) / (kFastest - fit.contact_speed);
  fit.contact_speed = speed;
  fit.contact_release_speed = std::max(fit.contact_release_speed, kRelease * speed);
  fit.contact_height += kHigher * share;
  fit.contact_release_height += kReleaseHigher * share;
}

// Drift of video estimates is rarely larger than kUsualDrift; a larger one means that the path itself
// may be wrong. Under noisy legs, even a smaller drift is uncertain.
void doubt_path(const CleanReport& report, Plan& plan) {
  constexpr double kUsualDrift = 0.5, kUncertainDrift = 0.2;  // Metres.
  const std::string moved = number_text(report.root_moved, 2);
  if (report.root_moved > kUsualDrift) {
    plan.clip_doubts.push_back(
        {0, 0,
         fmt::format("the path of the root contradicted the feet by up to {} m and was corrected; "
                     "the unit, scale or axes of the root translation may be wrong",
                     moved)});
  } else if (report.foot_noise.wander > 0.0 && report.root_moved > kUncertainDrift) {
    plan.clip_doubts.push_back(
        {0, 0,
         fmt::format("the root was moved by up to {} m, according to feet whose legs have noise: "
                     "its path is uncertain by as much",
                     moved)});
  }
}

// Interpolation over a long freeze would invent a movement, so the frames are kept.
void doubt_freezes(const Clip& clip, Plan& plan) {
  const std::vector<FrameRange> freezes =
      kept_freezes(clip, plan.part, plan.human.calibration.metres_per_unit);
  if (freezes.empty()) return;
  int frames = 0;
  std::vector<std::string> places;
  for (const FrameRange& freeze : freezes) {
    frames += freeze.end - freeze.begin;
    places.push_back(fmt::format("{} to {}", freeze.begin, freeze.end - 1));
  }
  plan.clip_doubts.push_back(
      {0, 0,
       fmt::format(
           "the source stops abruptly in frames {} and moves on abruptly, as in a dropout of the "
           "tracking system: {} kept, {} s",
           list_names(places), count_text(frames, "equal frame"),
           number_text(frames * clip.rate().frame_time(), 2))});
}

void doubt_limbs(const Clip& clip, Plan& plan) {
  const StillLimbs still = find_still_limbs(clip, plan.human.calibration);
  if (still.all) {
    plan.clip_doubts.push_back(
        {0, 0,
         "no arm and no leg moves in the whole clip: it holds one pose, or other joints than the "
         "recognised ones move"});
  }
  for (const std::string& name : still.names) {
    plan.clip_doubts.push_back(
        {0, 0,
         fmt::format(
             "the {} does not move while the other limbs do: it was held still or not tracked",
             name)});
  }
}

void restore_height(Clip& clip, Plan& plan) {
  const auto moved = restore_centred_height(clip, plan.part, plan.human.calibration);
  if (!moved) return;
  plan.clip_doubts.push_back(
      {0, 0,
       fmt::format("the root rests at one place: it is missing or centred; its height was restored "
                   "from the lowest part of the body, by up to {} m, without jumps and travel",
                   number_text(*moved, 2))});
}

// The rule of `auto` for the G1, by the robot's speed.
constexpr TravelRule kAutomatic{1.0, 0.85, 0.7, 1.5};

// The same by the speed of the human whose path the robot follows.
Result<TravelRule> automatic_rule(const Clip& clip, const Plan& plan) {
  TRY_ASSIGN(const double scale, foot_path_scale(clip, plan));
  const double leg = robot_leg_length(*plan.robot.robot, plan.config).value_or(kUsualLeg);
  TravelRule rule = kAutomatic;
  if (!(scale > 0.0)) return rule;
  const double faster = std::sqrt(leg / kUsualLeg) / scale;
  rule.slow_speed *= faster;
  rule.fast_speed *= faster;
  return rule;
}

std::string travel_text(const TravelReport& travel) {
  const std::string mean = "the path over the ground is scaled by " + number_text(travel.factor, 3);
  if (travel.least == travel.greatest) return mean;
  return mean + ", from " + number_text(travel.least, 3) + " to " + number_text(travel.greatest, 3);
}

}  // namespace

SourceNotes clean_source_frames(Clip& clip, const Options& options) {
  SourceNotes notes;
  if (!may_clean(clip, options)) return notes;
  const int held = interpolate_held_frames(clip, {0, clip.frame_count()});
  if (held > 0) {
    notes.held = fmt::format("{} interpolated", count_text(held, "repeated frame"));
  }
  notes.swaps = undo_position_swaps(clip);
  notes.spikes = bridge_position_spikes(clip);
  notes.positions = clean_positions(clip);
  return notes;
}

Result<HumanInClip> find_human_as_run(Clip& clip, const Options& options,
                                      const std::string& data_folder) {
  (void)clean_source_frames(clip, options);
  return find_human(clip, options.human, data_folder);
}

void leave_out_lost_end(const Clip& clip, const Options& options, Plan& plan) {
  const PartOptions& part = options.part;
  if (!may_clean(clip, options) || !part.frames.empty() || part.end_s >= 0.0) return;
  const int count = count_lost_end_frames(clip);
  const int end = clip.frame_count() - count;
  if (count == 0 || plan.part.begin >= end) return;
  plan.part.end = end;
  plan.clip_notes.push_back(
      {"end", fmt::format("{} at the end skipped, because the motion jumps to zeros there; " OPTION(
                              "clean") " off uses {}",
                          count_text(count, "frame"), count == 1 ? "it" : "them")});
}

Result<void> clean_source(Clip& clip, const SourceNotes& notes, Plan& plan) {
  if (!may_clean(clip, plan.options)) return {};
  TRY_ASSIGN(const bool rides, stands_on_moving_body(clip, plan));
  for (const std::string& swap : notes.swaps.kept) plan.clip_doubts.push_back({0, 0, swap});
  doubt_freezes(clip, plan);
  doubt_limbs(clip, plan);
  if (!plan.scene) restore_height(clip, plan);
  CleanReport report =
      clean_clip(clip, plan.part, plan.human.calibration, notes.positions.foot_noise,
                 rides ? RootRule::kKept : RootRule::kFollowsFeet);
  std::vector<std::string> first;
  for (const std::string& note : {notes.held, notes.positions.note}) {
    if (!note.empty()) first.push_back(note);
  }
  for (const std::string& swap : notes.swaps.undone) first.push_back(swap + ": undone");
  for (const std::string& spike : notes.spikes) first.push_back(spike + ": bridged");
  report.notes.insert(report.notes.begin(), first.begin(), first.end());
  if (!report.acted()) return {};
  for (const std::string& note : report.notes) {
    plan.clip_notes.push_back({&note == report.notes.data() ? "cleaned" : "", note});
  }
  plan.clip_notes.push_back({"", OPTION("clean") " off uses the clip unchanged"});
  doubt_path(report, plan);
  look_above_noise(report.foot_noise.speed, plan.fit);
  constexpr double kNoisySpeed = 0.15;  // m/s: standing feet of video estimates, after smoothing.
  plan.fit = options_for_noise(plan.fit, std::min(1.0, report.foot_noise.speed / kNoisySpeed));
  return {};
}

void doubt_jumps(const Clip& clip, Plan& plan) {
  if (is_of_robot(clip)) return;
  HumanPoser poser(clip, plan.human.calibration);
  // A calibration pose before the motion does not belong to it.
  const FrameRange part = {std::max(plan.part.begin, count_lead_in_frames(clip)), plan.part.end};
  // Rotations that were computed from positions turn fast about straight legs.
  const SourceJumps jumps = find_source_jumps(poser, part, clip.origin().unknown_rotations.empty());
  if (jumps.frames == 0) return;
  plan.clip_doubts.push_back(
      {0, 0,
       fmt::format("{} in {}, first in frame {}: probably an error of the tracking system, or "
                   "a cut",
                   list_names(jumps.texts()), count_text(jumps.frames, "frame"), jumps.first)});
}

void doubt_level(const Clip& clip, Plan& plan) {
  if (is_of_robot(clip) || !plan.options.solve.scene.empty()) return;
  HumanPoser poser(clip, plan.human.calibration);
  const auto tilt = find_floor_tilt(poser, plan.part);
  if (!tilt) return;
  const Eigen::Vector3d up = plan.human.calibration.human_from_source.transpose() * tilt->up;
  const std::string option =
      fmt::format(OPTION("up") " {:.3f},{:.3f},{:.3f}", up.x(), up.y(), up.z());
  const double degrees = tilt->angle * 180.0 / std::numbers::pi;
  plan.clip_doubts.push_back(
      {0, 0,
       tilt->by_balance
           ? fmt::format(
                 "the world is tilted by about {:.0f} degrees: a body that stands still on "
                 "one spot is balanced only then; {} levels the clip to within about {:.0f} "
                 "degrees",
                 degrees, option, kBalanceError)
           : fmt::format("the floor is tilted by {:.0f} degrees: standing feet and the body above "
                         "them agree; {} levels the clip",
                         degrees, option)});
}

Result<void> scale_source_travel(Clip& clip, Plan& plan) {
  const std::string chosen = chosen_travel(plan.options.solve);
  if (chosen.empty()) {
    if (plan.options.solve.purpose == Purpose::kTracking && plan.scene) {
      plan.clip_notes.push_back({"travel", "the path is not scaled, because the scene is not"});
    }
    return {};
  }
  if (plan.robot.robot->fixed_base()) {
    plan.clip_notes.push_back({"travel", "the base is fixed: no path to scale"});
    return {};
  }
  TRY_ASSIGN(const auto factor, travel_from_text(chosen));
  TravelRule rule;
  if (factor) {
    rule.slow = rule.fast = *factor;
  } else {
    TRY_ASSIGN(rule, automatic_rule(clip, plan));
  }
  plan.travel = scale_travel(clip, plan.lead_in_frames, plan.part, plan.human.calibration, rule,
                             contact_options(plan.fit));
  plan.clip_notes.push_back({"travel", travel_text(*plan.travel)});
  return {};
}

}  // namespace retarget
