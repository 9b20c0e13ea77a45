#include "solve/fit/foot_plan.h"

#include <algorithm>
#include <cmath>

#include "retarget/human.h"
#include "solve/fit/shorthand.h"

namespace retarget {
namespace {

// Height of the foot's unit up vector. Below kLyingFoot, clearance has no weight; above kLyingFoot
// + kUprightRange, it has its full weight.
constexpr double kLyingFoot = 0.2, kUprightRange = 0.35;
// Half-width of a sole, metres: when a foot leans on its edge, its middle line rises by this times
// the slope.
constexpr double kHalfWidth = 0.03;

// Increases the clearance weights in flight. While all feet are in the air, only their clearances
// determine how high the body flies. For each foot, the lower end decides: the robot's foot is
// shorter or longer than the source's, so both clearances of a tucked foot cannot be met. A phase
// that lasts too long stands on something; a body that does not fall freely lies or sits. Neither
// counts as flight.
void stress_flights(const SourceFeet& source, FootPlan& plan) {
  constexpr double kAloft = 0.02, kWholly = 0.05;  // Metres.
  constexpr double kMaxFlightTime = 1.0;           // Seconds.
  constexpr double kFreeFallShare = 0.25;
  constexpr double kImportance = 5.0;
  // Metres. An end that is higher than the other by this much gets no extra weight.
  constexpr double kLowerEnd = 0.05;
  const auto feet = static_cast<std::size_t>(plan.foot_count);
  const int frames = source.frame_count();
  const auto at_frame = [&](int frame) {
    return std::span(plan.ends).subspan(2 * feet * static_cast<std::size_t>(frame), 2 * feet);
  };
  const auto lowest = [&](int frame) {
    double min = HUGE_VAL;
    for (const FootEndGoal& goal : at_frame(frame)) {
      min = std::min(min, goal.level ? 0.0 : goal.clearance);
    }
    return min;
  };
  for (int begin = 0; begin < frames;) {
    int end = begin;
    while (end < frames && lowest(end) > kAloft) ++end;
    const bool flies = begin < end && (end - begin) * source.frame_time <= kMaxFlightTime &&
                       (source.hips.empty() ||
                        falls_freely(std::span(source.hips).subspan(at(begin), at(end - begin)),
                                     source.frame_time, kFreeFallShare));
    for (int frame = begin; flies && frame < end; ++frame) {
      const double share = std::min(1.0, (lowest(frame) - kAloft) / (kWholly - kAloft));
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

}  // namespace

std::span<const FootEndGoal> FootPlan::ends_of(int frame) const {
  const auto feet = static_cast<std::size_t>(foot_count);
  return {ends.data() + static_cast<std::size_t>(frame) * 2 * feet, 2 * feet};
}

std::span<const double> FootPlan::upright_of(int frame) const {
  const auto feet = static_cast<std::size_t>(foot_count);
  return {upright.data() + static_cast<std::size_t>(frame) * feet, feet};
}

std::span<const SupportGoal> FootPlan::supports_of(int frame) const {
  const auto count = static_cast<std::size_t>(support_count);
  return {supports.data() + static_cast<std::size_t>(frame) * count, count};
}

void FootPlan::reserve(int frames, std::size_t feet, std::size_t bodies) {
  ends.reserve(at(frames) * 2 * feet);
  upright.reserve(at(frames) * feet);
  supports.reserve(at(frames) * bodies);
  // Phases of the same foot end or body do not share frames.
  phases.reserve(at(frames) * (2 * feet + bodies));
}

bool FootPlan::plants(int frame) const {
  return std::ranges::any_of(ends_of(frame),
                             [](const FootEndGoal& end) { return end.phase >= 0; }) ||
         std::ranges::any_of(supports_of(frame),
                             [](const SupportGoal& goal) { return goal.place > 0.0; });
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

void plan_feet(const SourceFeet& source, const ContactPlan& contacts,
               std::span<const int> source_feet, double scale, FootPlan& plan) {
  plan.foot_count = static_cast<int>(source_feet.size());
  plan.support_count = 0;
  plan.ends.clear();
  plan.upright.clear();
  plan.supports.clear();
  plan.phases.clear();
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    for (const int side : source_feet) {
      const SourceFoot& foot = source.at(frame, side);
      const double upright = std::clamp((foot.up - kLyingFoot) / kUprightRange, 0.0, 1.0);
      plan.upright.push_back(upright);
      for (const int end : {kHeelEnd, kToeEnd}) {
        FootEndGoal goal;
        goal.clearance = std::max(0.0, scale * (foot.end(end).z() - contacts.standing.of(end)));
        // A known sole gives the height of its middle line directly.
        if (!foot.heel) goal.clearance += kHalfWidth * scale * std::abs(foot.side);
        goal.importance = std::sqrt(upright);
        plan.ends.push_back(goal);
      }
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
  if (plan.foot_count > 0) stress_flights(source, plan);
}

void plan_supports(const ContactPlan& contacts, std::span<const SupportBody> supports, int frames,
                   double frame_time, FootPlan& plan) {
  // Seconds. Blends the weights, so that a body does not jump to its anchor or off it.
  constexpr double kBlendTime = 0.1;
  const int blend = std::max(1, static_cast<int>(std::lround(kBlendTime / frame_time)));
  plan.support_count = static_cast<int>(supports.size());
  plan.supports.assign(at(frames) * supports.size(), {});
  for (std::size_t i = 0; i < supports.size(); ++i) {
    for (const ContactPhase& phase : contacts.bodies[supports[i].support]) {
      // The approach begins before the contact and the departure ends after it.
      const int from = std::max(0, phase.begin - blend), to = std::min(frames, phase.end + blend);
      for (int frame = from; frame < to; ++frame) {
        SupportGoal& goal = plan.supports[at(frame) * supports.size() + i];
        const int inside = std::min(frame - phase.begin, phase.end - 1 - frame) + 1;
        const double height = std::min(1.0, static_cast<double>(inside + blend) / (blend + 1));
        if (height <= goal.height) continue;
        const double place = static_cast<double>(inside) / (blend + 1);
        goal = {static_cast<int>(plan.phases.size()), std::clamp(place, 0.0, 1.0), height};
      }
      plan.phases.push_back({phase.begin, phase.end, -1, kHeelEnd, static_cast<int>(i)});
    }
  }
}

}  // namespace retarget
