#include "human/gait/contact_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/math/gravity.h"
#include "human/gait/frame_runs.h"
#include "human/gait/standing_heights.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// Minimum z of the up vector of a heel and of a toe that may be flat on the floor, and maximum |z|
// of the toe's side vector.
constexpr double kHeelUp = 0.75, kToeUp = 0.1, kToeSide = 0.35;
constexpr double kMinLevelTime = 1.0 / 6.0;  // Seconds.
// Seconds for which a part of a drifting run must stay in place to be a raised stance.
constexpr double kMinDriftingStance = 0.5;
// Metres: a toe alone stands only on surfaces at least as high as a low stair. Bumps of a floor are
// lower, and toes roll over them.
constexpr double kMinStair = 0.1;
constexpr std::array kBothEnds{kHeelEnd, kToeEnd};
constexpr std::array kToeOnly{kToeEnd};
// Height difference of heel and toe, metres, below which the surface is level.
constexpr double kFlat = 0.03;
// Support of one end of a foot: the index of a raised stance, or one of these.
constexpr int kUnsupported = -2, kFloor = -1;

// A period in which a whole foot is still above the floor, and the surface height under each end.
struct RaisedStance {
  int begin = 0, end = 0;
  std::array<double, 2> height{};
};

// Contacts of one foot; the standing heights of the source are known.
class FootContactFinder {
 public:
  /// Finds the supports of both ends while they are slow. Call this first. The arguments must
  /// outlive all later calls.
  void find_stands(const SourceFeet& source, const ContactPlan& plan, const ContactOptions& options,
                   int foot) {
    source_ = &source;
    standing_ = &plan.standing;
    options_ = &options;
    size_ = plan.scale;
    foot_ = foot;
    frames_ = source.frame_count();
    raised_.clear();
    for (auto& of_end : stands_on_) {
      of_end.assign(static_cast<std::size_t>(frames_), kUnsupported);
    }
    if (has(kHeelEnd) && has(kToeEnd)) find_raised_stances();
    for (const int end : {kHeelEnd, kToeEnd}) {
      if (!has(end)) continue;
      stand_on_floor(end);
      for (std::size_t i = 0; i < raised_.size(); ++i) stand_raised(static_cast<int>(i), end);
    }
  }

  // Finds raised stances that find_raised_stances omits, because feet in the air look the same.
  // They count if nothing else supports the body: a slow foot that moves farther than
  // support_drift, as when a person on a step lifts the heel slowly, and a still toe below a moving
  // heel, as on stairs. Call this after find_stands of all feet.
  // @param carries(frame)  whether the body is supported although no part of it is in contact.
  template <typename Carries>
  void find_carrying_stances(const Carries& carries) {
    if (!has(kHeelEnd) || !has(kToeEnd)) return;
    find_carrying_stances(kBothEnds, 0.0, kMinDriftingStance, carries);
    find_carrying_stances(kToeOnly, kMinStair * size_, options_->support_time, carries);
  }

  [[nodiscard]] bool stands(int frame, int end) const {
    return stands_on(frame, end) != kUnsupported;
  }
  /// Speed of an end near the floor in m/s, scaled as in ContactOptions; nothing if the end is
  /// higher.
  [[nodiscard]] std::optional<double> speed_near_floor(int frame, int end) const {
    if (!has(end) || height(frame, end) > options_->begin_height * size_) return std::nullopt;
    return source_->speed(frame, foot_, end) / size_;
  }
  void stand_in(int frame, int end) { stands_on_[end][static_cast<std::size_t>(frame)] = kFloor; }

  void find_contacts_of_ends(std::array<EndContacts, 2>& ends) const {
    for (const int end : {kHeelEnd, kToeEnd}) {
      if (!has(end)) continue;
      add_phases(end, ends[end]);
      for (const ContactPhase& phase : ends[end].phases) smooth_levels(phase, ends[end].level);
    }
  }

  void find_whole_foot(std::vector<ContactPhase>& phases) {
    const int last = has(kToeEnd) ? kToeEnd : kHeelEnd;
    std::vector<int>& both = both_stand_on_;
    both.assign(static_cast<std::size_t>(frames_), kUnsupported);
    for (int frame = 0; frame < frames_; ++frame) {
      const bool on = frame > 0 && both[frame - 1] != kUnsupported;
      const double low = on ? options_->end_height : options_->begin_height;
      // The standing height of an ankle may be a guess, in which case no ankle counts as too low.
      const bool lies = standing_->found && -height(frame, kHeelEnd) > low * size_;
      const int under = stands_on(frame, kHeelEnd);
      if (stands_on(frame, last) == under && !lies) both[frame] = under;
    }
    for_each_run(
        0, frames_, [&](int frame) { return both[frame]; },
        [&](int begin, int end) {
          if (both[begin] == kUnsupported || !lasts(end - begin, options_->shortest)) return;
          phases.push_back(
              {begin, end, 0.5 * (support(both[begin], kHeelEnd) + support(both[begin], last))});
        });
  }

  void reserve(std::size_t frames) {
    raised_.reserve(frames);
    for (auto& of_end : stands_on_) of_end.reserve(frames);
    both_stand_on_.reserve(frames);
    heights_.reserve(frames);
  }

 private:
  [[nodiscard]] bool has(int end) const { return source_->has(foot_, end); }
  [[nodiscard]] int stands_on(int frame, int end) const {
    return stands_on_[end][static_cast<std::size_t>(frame)];
  }
  [[nodiscard]] const Eigen::Vector3d& place(int frame, int end) const {
    return source_->at(frame, foot_).end(end);
  }
  [[nodiscard]] double height(int frame, int end) const {
    return place(frame, end).z() - standing_->of(end);
  }
  [[nodiscard]] bool is_slow(int frame, int end, double speed) const {
    return source_->speed(frame, foot_, end) <= speed * size_;
  }
  [[nodiscard]] bool lasts(int frames, double seconds) const {
    return frames * source_->frame_time >= seconds - 1e-9;
  }
  [[nodiscard]] double support(int under, int end) const {
    return under == kFloor ? 0.0 : raised_[static_cast<std::size_t>(under)].height[end];
  }

  void stand_on_floor(int end) {
    bool on = false;
    for (int frame = 0; frame < frames_; ++frame) {
      const double high = on ? options_->end_height : options_->begin_height;
      on = height(frame, end) <= high * size_ &&
           is_slow(frame, end, on ? options_->end_speed : options_->begin_speed);
      if (on) stands_on_[end][static_cast<std::size_t>(frame)] = kFloor;
    }
  }

  // @param ends  foot ends that must be still.
  [[nodiscard]] bool is_still_above_floor(int frame, std::span<const int> ends) const {
    return source_->at(frame, foot_).up > kSoleUp && std::ranges::all_of(ends, [&](int end) {
             return height(frame, end) > options_->begin_height * size_ &&
                    source_->speed(frame, foot_, end) < options_->begin_speed * size_;
           });
  }

  // Returns the first frame up to `end` in which the ends have moved too far since frame `first`.
  [[nodiscard]] int end_in_place(int first, int end, std::span<const int> ends) const {
    std::array<Eigen::AlignedBox3d, 2> boxes;
    for (int frame = first; frame < end; ++frame) {
      for (const int foot_end : ends) {
        boxes[foot_end].extend(place(frame, foot_end));
        if (!(boxes[foot_end].sizes().maxCoeff() <= options_->support_drift * size_)) return frame;
      }
    }
    return end;
  }

  void add_raised_stance(int begin, int end) {
    RaisedStance stance{begin, end, {}};
    for (const int foot_end : {kHeelEnd, kToeEnd}) {
      heights_.clear();
      for (int frame = begin; frame < end; ++frame) heights_.push_back(height(frame, foot_end));
      stance.height[foot_end] = median_in_place(heights_);
    }
    if (std::abs(stance.height[kHeelEnd] - stance.height[kToeEnd]) < kFlat * size_) {
      stance.height.fill(0.5 * (stance.height[kHeelEnd] + stance.height[kToeEnd]));
    }
    raised_.push_back(stance);
  }

  // Returns the longest part of the run in which the ends stay in place, up to an eighth of its
  // length.
  [[nodiscard]] ContactPhase longest_in_place(int begin, int end, std::span<const int> ends) const {
    ContactPhase longest{begin, begin, 0.0};
    for (int first = begin; first < end;) {
      const int last = end_in_place(first, end, ends);
      if (last - first > longest.end - longest.begin) longest = {first, last, 0.0};
      first += std::max(1, (last - first) / 8);
    }
    return longest;
  }

  // @param min_height  height of the toe, metres.
  // @param min_time    seconds.
  template <typename Carries>
  void find_carrying_stances(std::span<const int> ends, double min_height, double min_time,
                             const Carries& carries) {
    const auto is_free_and_still = [&](int frame) {
      return !stands(frame, kToeEnd) && height(frame, kToeEnd) > min_height &&
             is_still_above_floor(frame, ends);
    };
    for_each_run_where(0, frames_, is_free_and_still, [&](int begin, int end) {
      const ContactPhase part = longest_in_place(begin, end, ends);
      if (!lasts(part.end - part.begin, min_time)) return;
      int alone = 0;
      for (int frame = part.begin; frame < part.end; ++frame) alone += carries(frame) ? 1 : 0;
      if (2 * alone < part.end - part.begin) return;
      add_raised_stance(part.begin, part.end);
      for (const int foot_end : ends) stand_raised(static_cast<int>(raised_.size()) - 1, foot_end);
    });
  }

  void find_raised_stances() {
    const auto is_still = [&](int frame) { return is_still_above_floor(frame, kBothEnds); };
    for_each_run_where(0, frames_, is_still, [&](int begin, int end) {
      if (!lasts(end - begin, options_->support_time)) return;
      if (end_in_place(begin, end, kBothEnds) == end) add_raised_stance(begin, end);
    });
  }

  // Marks the frames of a raised stance, and the frames around it in which this end is already, or
  // still, in place.
  void stand_raised(int index, int end) {
    const RaisedStance& stance = raised_[static_cast<std::size_t>(index)];
    const auto mark = [&](int frame) {
      int& under = stands_on_[end][static_cast<std::size_t>(frame)];
      if (under != kUnsupported) return false;
      under = index;
      return true;
    };
    for (int frame = stance.begin; frame < stance.end; ++frame) mark(frame);
    const auto near = [&](int frame, int edge, double speed) {
      return (place(frame, end) - place(edge, end)).norm() <= options_->support_drift * size_ &&
             is_slow(frame, end, speed);
    };
    for (int frame = stance.begin - 1; frame >= 0; --frame) {
      if (!near(frame, stance.begin, options_->begin_speed) || !mark(frame)) break;
    }
    for (int frame = stance.end; frame < frames_; ++frame) {
      if (!near(frame, stance.end - 1, options_->end_speed) || !mark(frame)) break;
    }
  }

  void add_phases(int end, EndContacts& contacts) const {
    contacts.level.assign(static_cast<std::size_t>(frames_), 0);
    for_each_run(
        0, frames_, [&](int frame) { return stands_on(frame, end); },
        [&](int begin, int last) {
          const int under = stands_on(begin, end);
          const bool goes_on = options_->goes_on && last == frames_;
          if (under == kUnsupported || !(goes_on || lasts(last - begin, options_->shortest)))
            return;
          contacts.phases.push_back({begin, last, support(under, end)});
          for (int frame = begin; frame < last; ++frame) {
            const SourceFoot& foot = source_->at(frame, foot_);
            const bool level = end == kHeelEnd ? foot.up > kHeelUp
                                               : foot.up > kToeUp && std::abs(foot.side) < kToeSide;
            contacts.level[static_cast<std::size_t>(frame)] = level ? 1 : 0;
          }
        });
  }

  // Removes short changes within a phase, in both directions.
  void smooth_levels(const ContactPhase& phase, std::vector<char>& levels) const {
    for (const char passed_over : {0, 1}) {
      for_each_run(
          phase.begin, phase.end, [&](int frame) { return levels[frame]; },
          [&](int begin, int end) {
            const bool inside = begin > phase.begin && end < phase.end;
            if (!inside || levels[begin] != passed_over || lasts(end - begin, kMinLevelTime))
              return;
            std::fill(levels.begin() + begin, levels.begin() + end,
                      static_cast<char>(1 - passed_over));
          });
    }
  }

  const SourceFeet* source_ = nullptr;
  const StandingHeights* standing_ = nullptr;
  const ContactOptions* options_ = nullptr;
  double size_ = 1.0;
  int foot_ = 0;
  int frames_ = 0;
  std::vector<RaisedStance> raised_;
  std::array<std::vector<int>, 2> stands_on_;  // Indexed by end and frame.
  std::vector<int> both_stand_on_;             // One per frame: the support that both ends share.
  std::vector<double> heights_;
};

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
  for (FootContactFinder& foot : feet) {
    foot.find_carrying_stances([&](int frame) {
      return is_held_up(source, frame) && !rests_on_body(frame) &&
             std::ranges::none_of(feet, [&](const FootContactFinder& other) {
               return other.stands(frame, kHeelEnd) || other.stands(frame, kToeEnd);
             });
    });
  }
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
