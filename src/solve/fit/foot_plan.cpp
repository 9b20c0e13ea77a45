#include "solve/fit/foot_plan.h"

#include <algorithm>
#include <cmath>

#include "human/gait/standing_heights.h"
#include "retarget/human.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

// Thresholds for the vertical component of the foot's unit up vector. Below kLyingFoot, the
// clearance weight is 0; it reaches its full value at kLyingFoot + kUprightRange.
constexpr double kLyingFoot = 0.2, kUprightRange = 0.35;
// Height of the lower foot end above its standing height from which a foot does not lie, metres.
constexpr double kLyingReach = 0.12;
// Half-width of a sole, metres. The centre line of a foot that leans on its edge rises by this
// times the lateral slope.
constexpr double kHalfWidth = 0.03;

// Height of the source's end above the surface below it, metres.
double above_surface(const FootEndGoal& goal) {
  return goal.clearance - goal.support;
}

// Increases the clearance weights in flight. While all feet are off the ground, only their
// clearances determine the height of the body. The increase is largest for the lower end of a foot,
// because a robot's foot has another length than the source's and cannot meet both clearances of a
// tucked foot. An interval that lasts too long is not a flight, because the body must have another
// support. Neither is one without free fall, because the body lies or sits.
void stress_flights(const SourceFeet& source, FootPlan& plan) {
  // Heights of the lowest foot end at which the extra weight begins and is full, metres.
  constexpr double kFlightHeight = 0.02, kFullHeight = 0.05;
  constexpr double kMaxFlightTime = 1.0;  // Seconds.
  constexpr double kFreeFallShare = 0.25;
  constexpr double kImportance = 5.0;
  constexpr double kLowerEnd = 0.05;  // Height above the lower end without extra weight, metres.
  const auto feet = static_cast<std::size_t>(plan.foot_count);
  const int frames = source.frame_count();
  const auto at_frame = [&](int frame) {
    return std::span(plan.ends).subspan(2 * feet * static_cast<std::size_t>(frame), 2 * feet);
  };
  const auto lowest = [&](int frame) {
    double min = HUGE_VAL;
    for (const FootEndGoal& goal : at_frame(frame)) {
      min = std::min(min, goal.level ? 0.0 : above_surface(goal));
    }
    return min;
  };
  for (int begin = 0; begin < frames;) {
    int end = begin;
    while (end < frames && lowest(end) > kFlightHeight) ++end;
    const bool flies = begin < end && (end - begin) * source.frame_time <= kMaxFlightTime &&
                       (source.hips.empty() ||
                        falls_freely(std::span(source.hips).subspan(at(begin), at(end - begin)),
                                     source.frame_time, kFreeFallShare));
    for (int frame = begin; flies && frame < end; ++frame) {
      const double share =
          std::min(1.0, (lowest(frame) - kFlightHeight) / (kFullHeight - kFlightHeight));
      for (std::size_t foot = 0; foot < feet; ++foot) {
        const auto ends = at_frame(frame).subspan(2 * foot, 2);
        const double low = std::min(ends[kHeelEnd].clearance, ends[kToeEnd].clearance);
        for (FootEndGoal& goal : ends) {
          const double stress = share * std::max(0.0, 1.0 - (goal.clearance - low) / kLowerEnd);
          goal.importance += stress * (kImportance - goal.importance);
        }
        double& upright = plan.upright[static_cast<std::size_t>(frame) * feet + foot];
        upright = std::max(upright, share);
      }
    }
    begin = end + 1;
  }
}

// Lets an end of a foot rise while the other one stays down, as in a squat or on tiptoe. A slow end
// stays in contact up to a height of several centimetres, and its anchor still holds it.
// @param begin_height  that of the contacts, metres for legs of 0.85 m. It grows with the noise.
void lift_ends(double begin_height, double scale, FootPlan& plan) {
  // Heights above the other end, relative to standing, at which the clearance begins to replace the
  // contact and replaces it in full.
  const double begin = std::max(begin_height - 0.03, 0.25 * begin_height), full = begin + 0.01;
  for (std::size_t i = 0; i + 1 < plan.ends.size(); i += 2) {
    FootEndGoal &heel = plan.ends[i], &toe = plan.ends[i + 1];
    if (heel.phase < 0 || toe.phase < 0 || !heel.level || !toe.level) continue;
    const bool heel_rises = above_surface(heel) > above_surface(toe);
    FootEndGoal& high = heel_rises ? heel : toe;
    const double over = above_surface(high) - std::max(0.0, above_surface(heel_rises ? toe : heel));
    high.lift = std::clamp((over / scale - begin) / (full - begin), 0.0, 1.0);
  }
}

// Plans the goals of support bodies.
class SupportPlanner {
 public:
  SupportPlanner(const SourceFeet& source, const ContactPlan& contacts, double scale)
      : source_(source), floor_(floor_height(contacts)), size_(contacts.scale), scale_(scale) {}

  // Adds a contact. In the frames before and after the contact, the goal moves like the source and
  // its weight is blended in and out, so that the body neither jumps to its anchor nor off it.
  void add(const ContactPhase& contact, std::size_t body, std::size_t support, int frames,
           FootPlan& plan) const {
    const int blend = blend_frames(source_.support(contact.begin, support).z());
    const int begin = std::max(0, contact.begin - blend);
    const int end = std::min(frames, contact.end + blend);
    const auto index = static_cast<int>(plan.phases.size());
    const auto joint = [&](int frame) { return source_.support(frame, support); };
    const auto set = [&](int frame, int away, const Eigen::Vector2d& slide) {
      SupportGoal& goal = plan.supports[at(frame) * at(plan.support_count) + body];
      const double share = 1.0 - static_cast<double>(away) / (blend + 1);
      if (share > goal.share) goal = {index, scale_ * slide, share};
    };
    for (int frame = begin; frame < contact.begin; ++frame) {
      set(frame, contact.begin - frame, (joint(frame) - joint(contact.begin)).head<2>());
    }
    SlideTracker tracker(joint(contact.begin), kRestingRadius * size_);
    Eigen::Vector2d slide = Eigen::Vector2d::Zero();
    for (int frame = contact.begin; frame < contact.end; ++frame) {
      slide = tracker.follow(joint(frame));
      set(frame, 0, slide);
    }
    for (int frame = contact.end; frame < end; ++frame) {
      set(frame, frame - contact.end + 1,
          slide + (joint(frame) - joint(contact.end - 1)).head<2>());
    }
    plan.phases.push_back({begin, end, -1, kHeelEnd, static_cast<int>(body), contact.begin - begin,
                           end - contact.end});
  }

 private:
  // A joint that is high for a resting part rests on the fingers of a hand. A robot with shorter
  // hands must lower its whole body, which takes longer.
  [[nodiscard]] int blend_frames(double joint_height) const {
    constexpr double kHigh = 0.18;                                  // Metres.
    constexpr double kBlendTime = 0.1, kLongBlendTime = 1.0 / 6.0;  // Seconds.
    const bool high = joint_height - floor_ > kHigh * size_;
    const double time = high ? kLongBlendTime : kBlendTime;
    return std::max(1, static_cast<int>(std::lround(time / source_.frame_time)));
  }

  const SourceFeet& source_;
  double floor_, size_, scale_;
};

// Whether a knee, elbow, hand, the seat or the back is held during this phase, on the floor or on a
// body of a scene at rest.
bool has_other_support(const FootPlan& plan, const FitScene* scene, const PlantedPhase& phase) {
  const auto rests = [&](const SceneGoal& goal) { return scene->may_carry(goal); };
  for (int frame = phase.begin; scene != nullptr && frame < phase.end; ++frame) {
    if (std::ranges::any_of(scene->goals_of(frame), rests)) return true;
  }
  const auto count = at(plan.support_count);
  const auto goals = std::span(plan.supports)
                         .subspan(at(phase.begin) * count, at(phase.end - phase.begin) * count);
  return std::ranges::any_of(goals, [](const SupportGoal& goal) { return goal.phase >= 0; });
}

}  // namespace

std::span<const FootEndGoal> FootPlan::ends_of(int frame) const {
  const auto feet = static_cast<std::size_t>(foot_count);
  return {ends.data() + static_cast<std::size_t>(frame) * 2 * feet, 2 * feet};
}

std::span<const double> FootPlan::upright_of(int frame) const {
  const auto feet = static_cast<std::size_t>(foot_count);
  return {upright.data() + static_cast<std::size_t>(frame) * feet, feet};
}

std::span<const double> FootPlan::lying_of(int frame) const {
  if (lying.empty()) return {};
  const auto feet = static_cast<std::size_t>(foot_count);
  return {lying.data() + static_cast<std::size_t>(frame) * feet, feet};
}

std::span<const SupportGoal> FootPlan::supports_of(int frame) const {
  const auto count = static_cast<std::size_t>(support_count);
  return {supports.data() + static_cast<std::size_t>(frame) * count, count};
}

void FootPlan::reserve(int frames, std::size_t feet, std::size_t bodies) {
  ends.reserve(at(frames) * 2 * feet);
  upright.reserve(at(frames) * feet);
  lying.reserve(at(frames) * feet);
  supports.reserve(at(frames) * bodies);
  // Phases of the same foot end or body do not share frames.
  phases.reserve(at(frames) * (2 * feet + bodies));
}

bool FootPlan::plants(int frame) const {
  return std::ranges::any_of(ends_of(frame),
                             [](const FootEndGoal& end) { return end.phase >= 0; }) ||
         std::ranges::any_of(supports_of(frame),
                             [&](const SupportGoal& goal) { return touches(goal, frame); });
}

RaisedFrames raised_frames(const FootPlan& plan, int frames) {
  RaisedFrames raised;
  for (int frame = 0; frame < frames; ++frame) {
    double highest = 0.0, lowest = HUGE_VAL;
    const auto ends = plan.ends_of(frame);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends[i].phase < 0) continue;
      // A foot that lies or kneels, as while a person gets up, does not stand on a surface.
      if (plan.upright_of(frame)[i / 2] < 0.5) lowest = 0.0;
      highest = std::max(highest, ends[i].support);
      lowest = std::min(lowest, ends[i].support);
    }
    // Hands, knees, seat and back only rest on the floor.
    const auto rests = [&](const SupportGoal& goal) { return goal.phase >= 0; };
    if (std::isinf(lowest) || !(lowest > 0.0)) continue;
    if (std::ranges::any_of(plan.supports_of(frame), rests)) continue;
    ++raised.count;
    raised.highest = std::max(raised.highest, highest);
  }
  return raised;
}

Eigen::Vector2d planted_place(const FitModel& model, const PlantedPhase& phase,
                              const TreeState& pose) {
  if (phase.support >= 0) return model.supports[at(phase.support)].world_middle(pose).head<2>();
  const FitFoot& foot = model.feet[at(phase.foot)];
  return (pose.world_from_link[at(foot.link)] * foot.ends[at(phase.foot_end)].middle).head<2>();
}

ContactOptions contact_options(const FitOptions& options) {
  return {.begin_speed = options.contact_speed,
          .begin_height = options.contact_height,
          .end_speed = options.contact_release_speed,
          .end_height = options.contact_release_height,
          .shortest = options.contact_time,
          .support_time = options.support_time,
          .support_drift = options.support_drift};
}

void plan_feet(const SourceFeet& source, const ContactPlan& contacts, const ContactOptions& options,
               std::span<const int> source_feet, double scale, std::span<const double> ground,
               FootPlan& plan) {
  plan.foot_count = static_cast<int>(source_feet.size());
  plan.support_count = 0;
  plan.ends.clear();
  plan.upright.clear();
  plan.lying.clear();
  plan.supports.clear();
  plan.phases.clear();
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    for (const int side : source_feet) {
      const SourceFoot& foot = source.at(frame, side);
      const double upright = std::clamp((foot.up - kLyingFoot) / kUprightRange, 0.0, 1.0);
      plan.upright.push_back(upright);
      double lowest = kLyingReach;
      for (const int end : {kHeelEnd, kToeEnd}) {
        FootEndGoal goal;
        goal.clearance = std::max(0.0, scale * (foot.end(end).z() - contacts.standing.of(end)));
        // The height of a known sole already includes the lateral slope.
        if (!foot.heel) goal.clearance += kHalfWidth * scale * std::abs(foot.side);
        goal.importance = std::sqrt(upright);
        if (!ground.empty()) {
          goal.support = scale * ground[at(2 * (frame * source.foot_count + side) + end)];
          goal.clearance = std::max(goal.clearance, goal.support);
        }
        plan.ends.push_back(goal);
        lowest = std::min(lowest, above_surface(goal));
      }
      plan.lying.push_back((1.0 - upright) * std::clamp(1.0 - lowest / kLyingReach, 0.0, 1.0));
    }
  }
  for (int foot = 0; foot < plan.foot_count; ++foot) {
    for (const int end : {kHeelEnd, kToeEnd}) {
      const EndContacts& of_end = contacts.ends[at(source_feet[at(foot)])][at(end)];
      for (const ContactPhase& phase : of_end.phases) {
        for (int frame = phase.begin; frame < phase.end; ++frame) {
          FootEndGoal& goal = plan.ends[at(2 * (frame * plan.foot_count + foot) + end)];
          goal.support = scale * phase.support;
          goal.phase = static_cast<int>(plan.phases.size());
          goal.level = of_end.level[at(frame)] != 0;
        }
        plan.phases.push_back({phase.begin, phase.end, foot, end});
      }
    }
  }
  lift_ends(options.begin_height, scale * contacts.scale, plan);
  if (plan.foot_count > 0) stress_flights(source, plan);
}

void plan_supports(const SourceFeet& source, const ContactPlan& contacts,
                   std::span<const SupportBody> supports, int frames, double scale,
                   FootPlan& plan) {
  plan.support_count = static_cast<int>(supports.size());
  plan.supports.assign(at(frames) * supports.size(), {});
  const SupportPlanner planner(source, contacts, scale);
  for (std::size_t i = 0; i < supports.size(); ++i) {
    for (const ContactPhase& phase : contacts.bodies[supports[i].support]) {
      planner.add(phase, i, supports[i].support, frames, plan);
    }
  }
}

// A foot that is held in one frame and free in the next changes its speed within a frame, so that
// its acceleration and the force on the anchor grow with the frame rate. The hold therefore fades
// within 1/30 s, the frame time for which the weights are tuned. The anchor moves with the source
// there, so that the foot does not lag. The force that remains grows with the rate, and so does the
// squared weight in the contact. Where other parts carry the body, it stays: while a body gets up,
// stiffer feet would push them into the floor.
void ease_contacts(const SourceFeet& source, std::span<const int> source_feet, double scale,
                   const FitScene* scene, FootPlan& plan) {
  constexpr double kFadeTime = 1.0 / 30.0;  // Seconds.
  constexpr double kFading = 4.6;           // Leaves a hundredth of the hold after kFadeTime.
  constexpr double kSameRate = 1e-3;        // 30.003 frames per second count as 30.
  const double frames_per_fade = kFadeTime / source.frame_time;
  const int fade = static_cast<int>(std::ceil(frames_per_fade - kSameRate)) - 1;
  if (fade < 1) return;
  for (std::size_t i = 0; i < plan.phases.size(); ++i) {
    PlantedPhase& phase = plan.phases[i];
    if (phase.support >= 0) continue;
    const int first = phase.begin, last = phase.end, side = source_feet[at(phase.foot)];
    const double hold = has_other_support(plan, scene, phase) ? 1.0 : std::sqrt(frames_per_fade);
    const auto goal_of = [&](int frame) -> FootEndGoal& {
      return plan.ends[at(2 * (frame * plan.foot_count + phase.foot) + phase.foot_end)];
    };
    const auto ease = [&](int frame, int contact) {
      FootEndGoal& goal = goal_of(frame);
      // exp(-kFading * time / kFadeTime) up to 1 %, but with the same bits on every machine.
      const double part = kFading / 16.0 * std::abs(frame - contact) / frames_per_fade;
      const double share = square(square(square((1.0 - part) / (1.0 + part))));
      if (goal.phase >= 0 || (goal.near_phase >= 0 && goal.hold >= share)) return;
      goal.near_phase = static_cast<int>(i);
      goal.hold = share;
      goal.slide = scale * (source.at(frame, side).end(phase.foot_end) -
                            source.at(contact, side).end(phase.foot_end))
                               .head<2>();
    };
    phase.begin = std::max(0, first - fade);
    phase.end = std::min(source.frame_count(), last + fade);
    phase.before = first - phase.begin;
    phase.after = phase.end - last;
    for (int frame = first; frame < last; ++frame) goal_of(frame).hold = hold;
    for (int frame = phase.begin; frame < first; ++frame) ease(frame, first);
    for (int frame = last; frame < phase.end; ++frame) ease(frame, last - 1);
  }
}

}  // namespace retarget
