#include "human/gait/contact_plan.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/math/gravity.h"
#include "human/gait/foot_contact_finder.h"
#include "human/gait/frame_runs.h"
#include "human/gait/standing_heights.h"

namespace retarget {
namespace {

// Whether the hips are not in free fall, from their acceleration over 1/30 s to either side.
bool is_held_up(const SourceFeet& source, int frame) {
  constexpr double kReach = 1.0 / 30.0;        // Seconds.
  constexpr double kFalls = -0.65 * kGravity;  // m/s^2
  const int half = frames_in(kReach, source.frame_time);
  const int frames = static_cast<int>(source.hips.size());
  if (frame - half < 0 || frame + half >= frames) return false;
  const auto hips = [&](int t) { return source.hips[static_cast<std::size_t>(t)]; };
  const double time = half * source.frame_time;
  return (hips(frame + half) - 2.0 * hips(frame) + hips(frame - half)) / (time * time) > kFalls;
}

void find_carrying_stances(const SourceFeet& source, const ContactPlan& plan,
                           std::span<FootContactFinder> feet) {
  const auto rests_on_body = [&](int frame) {
    return std::ranges::any_of(plan.bodies, [&](const std::vector<ContactPhase>& phases) {
      return std::ranges::any_of(phases, [&](const ContactPhase& phase) {
        return phase.begin <= frame && frame < phase.end;
      });
    });
  };
  const auto carries = [&](int frame) {
    return is_held_up(source, frame) && !rests_on_body(frame) &&
           std::ranges::none_of(feet, [&](const FootContactFinder& other) {
             return other.stands(frame, kHeelEnd) || other.stands(frame, kToeEnd);
           });
  };
  // A function of a reference allocates nothing.
  for (FootContactFinder& foot : feet) foot.find_carrying_stances(std::cref(carries));
}

// One end of a foot; foot -1: none.
struct FootEnd {
  int foot = -1, end = kHeelEnd;
  friend bool operator==(const FootEnd&, const FootEnd&) = default;
};

// Returns the slowest end near the floor, or none if any end is in contact in this frame.
FootEnd slowest_end(std::span<const FootContactFinder> feet, int frame) {
  constexpr double kFastest = 1.0;  // m/s
  FootEnd slowest;
  double min_speed = kFastest;
  for (int foot = 0; foot < static_cast<int>(feet.size()); ++foot) {
    for (const int end : {kHeelEnd, kToeEnd}) {
      const FootContactFinder& finder = feet[static_cast<std::size_t>(foot)];
      if (finder.stands(frame, end)) return {};
      const auto speed = finder.speed_near_floor(frame, end);
      if (!speed || *speed >= min_speed) continue;
      slowest = {foot, end};
      min_speed = *speed;
    }
  }
  return slowest;
}

// A body that is not falling must be supported. Running and landing feet slide during a stance of a
// few frames, so if nothing else is in contact, the slowest end near the floor is. An end that is
// in contact just before or after the run already has its position.
void stand_while_held_up(const SourceFeet& source, const ContactPlan& plan,
                         std::span<FootContactFinder> feet, std::vector<FootEnd>& carrying) {
  carrying.assign(static_cast<std::size_t>(source.frame_count()), FootEnd{});
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    if (is_held_up(source, frame)) {
      carrying[static_cast<std::size_t>(frame)] = slowest_end(feet, frame);
    }
  }
  for (const auto& phases : plan.bodies) {
    for (const ContactPhase& phase : phases) {
      std::fill(carrying.begin() + phase.begin, carrying.begin() + phase.end, FootEnd{});
    }
  }
  for_each_run(
      0, source.frame_count(), [&](int frame) { return carrying[static_cast<std::size_t>(frame)]; },
      [&](int begin, int end) {
        const FootEnd chosen = carrying[static_cast<std::size_t>(begin)];
        if (chosen.foot < 0) return;
        FootContactFinder& foot = feet[static_cast<std::size_t>(chosen.foot)];
        const bool stood = begin > 0 && foot.stands(begin - 1, chosen.end);
        const bool goes_on = end < source.frame_count() && foot.stands(end, chosen.end);
        if (stood || goes_on) return;
        for (int frame = begin; frame < end; ++frame) foot.stand_in(frame, chosen.end);
      });
}

}  // namespace

class ContactPlanner::Impl {
 public:
  const ContactPlan& plan(const SourceFeet& source, const ContactOptions& options) {
    clear();
    plan_.scale = source.leg_length(lengths_) / kUsualSourceLeg;
    plan_.standing = heights_.find(source, plan_.scale, options);
    find_body_contacts(source, plan_.standing, plan_.scale, options, plan_.bodies);
    const auto feet = std::span(feet_).first(static_cast<std::size_t>(source.foot_count));
    for (int foot = 0; foot < source.foot_count; ++foot) {
      feet[foot].find_stands(source, plan_, options, foot);
    }
    find_carrying_stances(source, plan_, feet);
    stand_while_held_up(source, plan_, feet, carrying_);
    for (int foot = 0; foot < source.foot_count; ++foot) {
      if (!source.has(foot, kHeelEnd)) continue;
      feet[foot].find_contacts_of_ends(plan_.ends[foot]);
      feet[foot].find_whole_foot(plan_.phases[foot]);
      phases_on_sole(source, foot, plan_.phases[foot], options.shortest, plan_.soles[foot]);
    }
    return plan_;
  }

  void reserve(int frames) {
    const auto count = static_cast<std::size_t>(frames);
    lengths_.reserve(count);
    heights_.reserve(frames);
    carrying_.reserve(count);
    for (FootContactFinder& foot : feet_) foot.reserve(count);
    // Phases do not overlap, so there are at most `count` of them.
    for (auto& ends : plan_.ends) {
      for (EndContacts& end : ends) {
        end.phases.reserve(count);
        end.level.reserve(count);
      }
    }
    for (auto& phases : plan_.phases) phases.reserve(count);
    for (auto& phases : plan_.soles) phases.reserve(count);
    for (auto& phases : plan_.bodies) phases.reserve(count);
  }

 private:
  // Clears all members that plan() only appends to; find_body_contacts clears plan_.bodies.
  void clear() {
    for (auto& ends : plan_.ends) {
      for (EndContacts& end : ends) {
        end.phases.clear();
        end.level.clear();
      }
    }
    for (auto& phases : plan_.phases) phases.clear();
    for (auto& phases : plan_.soles) phases.clear();
  }

  ContactPlan plan_;
  StandingHeightFinder heights_;
  std::vector<double> lengths_;
  std::array<FootContactFinder, 2> feet_;
  std::vector<FootEnd> carrying_;  // One per frame.
};

ContactPlanner::ContactPlanner() : impl_(std::make_unique<Impl>()) {}
ContactPlanner::~ContactPlanner() = default;
ContactPlanner::ContactPlanner(ContactPlanner&&) noexcept = default;
ContactPlanner& ContactPlanner::operator=(ContactPlanner&&) noexcept = default;

const ContactPlan& ContactPlanner::plan(const SourceFeet& source, const ContactOptions& options) {
  return impl_->plan(source, options);
}

void ContactPlanner::reserve(int frames) {
  impl_->reserve(frames);
}

}  // namespace retarget
