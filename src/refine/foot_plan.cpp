#include "refine/foot_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/statistics.h"
#include "refine/raised_stances.h"
#include "refine/shorthand.h"

namespace retarget {
namespace {

// height of the ankle over the toe by their distance, of feet that stand
constexpr double kFlattestFoot = 0.15, kSteepestFoot = 0.6, kCommonFoot = 0.36;
constexpr double kNearLowest = 0.05;    // metres
constexpr double kLowestShare = 0.02;   // of frames
constexpr double kLeastStanding = 0.7;  // seconds of both feet together
constexpr double kSunk = 0.25;          // metres that a body may be too low for a moment

// height of a foot's up vector: none of its clearance counts below the first, all beyond both
constexpr double kLyingFoot = 0.2, kUprightRange = 0.35;
// where a heel and a toe may be on the floor
constexpr double kHeelUp = 0.75, kToeUp = 0.1, kToeSide = 0.35;
// metres that a foot's middle line rises when it leans on its edge
constexpr double kHalfWidth = 0.03;
constexpr double kShortestLevel = 1.0 / 6.0;  // seconds

// what one end of a foot stands on: a raised stance's index, or
constexpr int kNothing = -2, kFloor = -1;

// one end of one foot
class EndPlanner {
 public:
  EndPlanner(const SourceFeet& source, double standing, double scale, const FitOptions& options,
             std::span<const RaisedStance> stances, int foot, int end, FootPlan& plan)
      : source_(source),
        standing_(standing),
        scale_(scale),
        options_(options),
        stances_(stances),
        foot_(foot),
        end_(end),
        plan_(plan),
        stands_on_(static_cast<std::size_t>(source.frame_count()), kNothing) {}

  void run() {
    const int frames = source_.frame_count();
    bool on = false;
    for (int frame = 0; frame < frames; ++frame) {
      const SourceFoot& source = source_.at(frame, foot_);
      const double height = source.end(end_).z() - standing_;
      goal(frame).clearance =
          std::max(0.0, scale_ * height) + kHalfWidth * scale_ * std::abs(source.side);
      on = stays(frame, height, on);
      if (on) stands_on(frame) = kFloor;
    }
    for (std::size_t i = 0; i < stances_.size(); ++i) raise(static_cast<int>(i));
    for (int begin = 0; begin < frames;) {
      int end = begin;
      while (end < frames && stands_on(end) == stands_on(begin)) ++end;
      if (stands_on(begin) != kNothing) add_phase(begin, end);
      begin = end;
    }
    smooth_levels();
  }

 private:
  int& stands_on(int frame) { return stands_on_[static_cast<std::size_t>(frame)]; }

  FootEndGoal& goal(int frame) {
    const std::size_t row =
        static_cast<std::size_t>(frame) * static_cast<std::size_t>(plan_.foot_count);
    return plan_.ends[2 * (row + static_cast<std::size_t>(foot_)) + static_cast<std::size_t>(end_)];
  }

  [[nodiscard]] bool stays(int frame, double height, bool on) const {
    const double size = source_.size();
    const double fast = on ? options_.contact_release_speed : options_.contact_speed;
    const double high = on ? options_.contact_release_height : options_.contact_height;
    return height <= high * size && source_.speed(frame, foot_, end_) <= fast * size;
  }

  // the frames of a raised stance, and those around it in which this end has come or not yet gone
  void raise(int index) {
    const RaisedStance& stance = stances_[static_cast<std::size_t>(index)];
    const auto mark = [&](int frame) {
      if (stands_on(frame) != kNothing) return false;
      stands_on(frame) = index;
      return true;
    };
    for (int frame = stance.begin; frame < stance.end; ++frame) mark(frame);
    const double size = source_.size();
    const auto near = [&](int frame, int edge, double fast) {
      const double away =
          (source_.at(frame, foot_).end(end_) - source_.at(edge, foot_).end(end_)).norm();
      return away <= options_.support_drift * size &&
             source_.speed(frame, foot_, end_) <= fast * size;
    };
    for (int frame = stance.begin - 1; frame >= 0; --frame) {
      if (!near(frame, stance.begin, options_.contact_speed) || !mark(frame)) break;
    }
    for (int frame = stance.end; frame < source_.frame_count(); ++frame) {
      if (!near(frame, stance.end - 1, options_.contact_release_speed) || !mark(frame)) break;
    }
  }

  void add_phase(int begin, int end) {
    if ((end - begin) * source_.frame_time < options_.contact_time - 1e-9) return;
    const int on = stands_on(begin);
    for (int frame = begin; frame < end; ++frame) {
      const SourceFoot& source = source_.at(frame, foot_);
      FootEndGoal& g = goal(frame);
      if (on != kFloor) g.support = scale_ * stances_[static_cast<std::size_t>(on)].height[end_];
      g.phase = static_cast<int>(plan_.phases.size());
      g.level = end_ == kHeel ? source.up > kHeelUp
                              : source.up > kToeUp && std::abs(source.side) < kToeSide;
    }
    plan_.phases.push_back({begin, end, foot_, end_});
  }

  // short changes within a phase, in either direction, are passed over
  void smooth_levels() {
    const int frames = source_.frame_count();
    for (const bool level : {false, true}) {
      for (int begin = 0; begin < frames;) {
        int end = begin;
        const FootEndGoal first = goal(begin);
        while (end < frames && goal(end).level == first.level && goal(end).phase == first.phase) {
          ++end;
        }
        const bool short_one = (end - begin) * source_.frame_time < kShortestLevel - 1e-9;
        if (first.phase >= 0 && first.level == level && short_one && begin > 0 && end < frames &&
            goal(begin - 1).phase == first.phase && goal(end).phase == first.phase) {
          for (int frame = begin; frame < end; ++frame) goal(frame).level = !level;
        }
        begin = end;
      }
    }
  }

  const SourceFeet& source_;
  double standing_;
  double scale_;
  const FitOptions& options_;
  std::span<const RaisedStance> stances_;
  int foot_;
  int end_;
  FootPlan& plan_;
  std::vector<int> stands_on_;  // by frame
};

// Whether the hips rise over the straight line between a flight's ends as what falls does, by
// g T^2 / 8. Less is asked for: they are not the centre of mass, and feet leave the floor early.
bool falls_freely(const SourceFeet& source, int begin, int end) {
  constexpr double kGravity = 9.81, kShare = 0.25;
  if (source.hips.empty() || begin >= end) return true;
  const auto hips =
      std::span(source.hips)
          .subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
  const double steps = static_cast<double>(hips.size()) - 1.0;
  const double slope = (hips.back() - hips.front()) / std::max(1.0, steps);
  double rise = 0.0;
  for (std::size_t i = 0; i < hips.size(); ++i) {
    rise = std::max(rise, hips[i] - hips.front() - slope * static_cast<double>(i));
  }
  return rise >= kShare * kGravity * square(steps * source.frame_time) / 8.0;
}

// While all feet are in the air nothing but their clearance says how high the body flies, and of a
// foot its lower end: the robot's foot is not as long as the source's, so that of a tucked one both
// cannot be had. What lasts longer stands on something, what does not fall lies or sits.
void stress_flights(const SourceFeet& source, FootPlan& plan) {
  constexpr double kAloft = 0.02, kWholly = 0.05;  // metres
  constexpr double kLongestFlight = 1.0;           // seconds
  constexpr double kImportance = 5.0;
  constexpr double kLowerEnd = 0.05;  // metres; an end so much higher than the other has no stress
  const auto feet = static_cast<std::size_t>(plan.foot_count);
  const int frames = source.frame_count();
  const auto at_frame = [&](int frame) {
    return std::span(plan.ends).subspan(2 * feet * static_cast<std::size_t>(frame), 2 * feet);
  };
  const auto lowest = [&](int frame) {
    double least = HUGE_VAL;
    for (const FootEndGoal& goal : at_frame(frame)) {
      least = std::min(least, goal.level ? 0.0 : goal.clearance);
    }
    return least;
  };
  for (int begin = 0; begin < frames;) {
    int end = begin;
    while (end < frames && lowest(end) > kAloft) ++end;
    const bool flies =
        (end - begin) * source.frame_time <= kLongestFlight && falls_freely(source, begin, end);
    for (int frame = begin; flies && frame < end; ++frame) {
      const double share = std::min(1.0, (lowest(frame) - kAloft) / (kWholly - kAloft));
      for (std::size_t foot = 0; foot < feet; ++foot) {
        const auto ends = at_frame(frame).subspan(2 * foot, 2);
        const double low = std::min(ends[kHeel].clearance, ends[kToe].clearance);
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

// a foot in a frame in which it is as slow and as steep as feet are that carry a body
struct StandingFoot {
  int frame = 0;
  double ankle = 0.0, toe = 0.0;  // heights
};

// by the height of their toes
std::vector<StandingFoot> feet_that_stand(const SourceFeet& source, const FitOptions& options) {
  const double size = source.size();
  std::vector<StandingFoot> standing;
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    for (int foot = 0; foot < source.foot_count; ++foot) {
      const SourceFoot& now = source.at(frame, foot);
      const double steep = (now.ankle.z() - now.toe.z()) / (now.ankle - now.toe).norm();
      if (steep > kFlattestFoot && steep < kSteepestFoot &&
          source.speed(frame, foot, kHeel) < options.contact_speed * size &&
          source.speed(frame, foot, kToe) < options.contact_speed * size) {
        standing.push_back({frame, now.ankle.z(), now.toe.z()});
      }
    }
  }
  std::ranges::stable_sort(standing, {}, &StandingFoot::toe);
  return standing;
}

// those of sorted feet whose toes are in [from, to)
std::span<const StandingFoot> between(std::span<const StandingFoot> standing, double from,
                                      double to) {
  const auto begin = std::ranges::lower_bound(standing, from, {}, &StandingFoot::toe);
  const auto end = std::ranges::lower_bound(begin, standing.end(), to, {}, &StandingFoot::toe);
  return {begin, end};
}

// Whether feet stand so for one moment alone and for little of the time that they stand at all: a
// body that sinks in behind a flip, or markers that are lost.
bool is_a_moment(std::span<const StandingFoot> level, std::size_t standing, double frame_time) {
  constexpr double kLittle = 0.1;
  if (static_cast<double>(level.size()) >= kLittle * static_cast<double>(standing)) return false;
  const auto [first, last] = std::ranges::minmax(level, {}, &StandingFoot::frame);
  return (last.frame - first.frame) * frame_time <= kLeastStanding;
}

// The feet that stand on the floor: those of the lowest level, up to `band` above the lowest toes,
// unless they do so for a moment and a level on which feet do stand is near. All else would stand
// in the air then.
std::span<const StandingFoot> feet_on_floor(std::span<const StandingFoot> standing, double lowest,
                                            double band, double near, double frame_time) {
  const auto level = between(standing, -HUGE_VAL, lowest + band);
  if (level.empty() || !is_a_moment(level, standing.size(), frame_time)) return level;
  for (const StandingFoot& foot : standing.subspan(level.size())) {
    if (foot.toe > lowest + near) break;
    const auto higher = between(standing, foot.toe, foot.toe + band);
    const bool carries = static_cast<double>(higher.size()) * frame_time > kLeastStanding;
    if (carries && !is_a_moment(higher, standing.size(), frame_time)) return higher;
  }
  return level;
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

StandingHeights find_standing_heights(const SourceFeet& source, const FitOptions& options) {
  StandingHeights result;
  const int frames = source.frame_count();
  if (frames == 0) return result;
  const double size = source.size();
  std::vector<double> lowest;
  lowest.reserve(static_cast<std::size_t>(frames));
  for (int frame = 0; frame < frames; ++frame) {
    double z = source.at(frame, 0).toe.z();
    for (int foot = 1; foot < source.foot_count; ++foot) {
      z = std::min(z, source.at(frame, foot).toe.z());
    }
    lowest.push_back(z);
  }
  const auto low = lowest.begin() + static_cast<std::ptrdiff_t>(kLowestShare * frames);
  std::ranges::nth_element(lowest, low);
  const double floor = *low;
  const std::vector<StandingFoot> standing = feet_that_stand(source, options);
  const auto level =
      feet_on_floor(standing, floor, kNearLowest * size, kSunk * size, source.frame_time);
  if (static_cast<double>(level.size()) * source.frame_time > kLeastStanding) {
    std::vector<double> ankles, toes;
    for (const StandingFoot& foot : level) {
      ankles.push_back(foot.ankle);
      toes.push_back(foot.toe);
    }
    return {median(std::move(ankles)), median(std::move(toes)), true};
  }
  const SourceFoot& first = source.at(0, 0);
  return {floor + kCommonFoot * (first.ankle - first.toe).norm(), floor, false};
}

FootPlan plan_feet(const SourceFeet& source, const StandingHeights& standing, double scale,
                   const FitOptions& options) {
  FootPlan plan;
  plan.foot_count = source.foot_count;
  plan.ends.resize(2 * source.feet.size());
  plan.upright.reserve(source.feet.size());
  for (const SourceFoot& foot : source.feet) {
    plan.upright.push_back(std::clamp((foot.up - kLyingFoot) / kUprightRange, 0.0, 1.0));
  }
  for (std::size_t i = 0; i < plan.ends.size(); ++i) {
    plan.ends[i].importance = std::sqrt(plan.upright[i / 2]);
  }
  for (int foot = 0; foot < source.foot_count; ++foot) {
    const auto stances = find_raised_stances(source, standing, foot, options);
    for (const int end : {kHeel, kToe}) {
      EndPlanner(source, standing.of(end), scale, options, stances, foot, end, plan).run();
    }
  }
  if (plan.foot_count > 0) stress_flights(source, plan);
  return plan;
}

}  // namespace retarget
