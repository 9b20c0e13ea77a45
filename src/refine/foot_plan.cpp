#include "refine/foot_plan.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

// thigh and shank of the body that lengths and speeds of the options are for, metres
constexpr double kLeg = 0.85;

// height of the ankle over the toe by their distance, of feet that stand
constexpr double kFlattestFoot = 0.15, kSteepestFoot = 0.6, kCommonFoot = 0.36;
constexpr double kNearLowest = 0.05;    // metres
constexpr double kLowestShare = 0.02;   // of frames
constexpr double kLeastStanding = 0.7;  // seconds of both feet together

// Speeds are taken over two frames or over this time, whichever says slower: the short one sees a
// foot come to rest early at any frame rate, the long one is not misled by noise of fast sources.
constexpr double kSpeedTime = 1.0 / 15.0;

// height of a foot's up vector: none of its clearance counts below the first, all beyond both
constexpr double kLyingFoot = 0.2, kUprightRange = 0.35;
// where a heel and a toe may be on the floor
constexpr double kHeelUp = 0.75, kToeUp = 0.1, kToeSide = 0.35;
// metres that a foot's middle line rises when it leans on its edge
constexpr double kHalfWidth = 0.03;
constexpr double kShortestLevel = 1.0 / 6.0;  // seconds

const Eigen::Vector3d& end_of(const SourceFoot& foot, int end) {
  return end == kHeel ? foot.ankle : foot.toe;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// m/s, over `half` frames on either side
double speed_over(const SourceFeet& source, int frame, int foot, int end, int half) {
  const int from = std::max(frame - half, 0), to = std::min(frame + half, source.frame_count() - 1);
  if (to == from) return 0.0;
  return (end_of(source.at(to, foot), end) - end_of(source.at(from, foot), end)).norm() /
         (source.frame_time * (to - from));
}

// m/s, over a short time about the frame
double speed(const SourceFeet& source, int frame, int foot, int end) {
  const int half = static_cast<int>(std::lround(0.5 * kSpeedTime / source.frame_time));
  const double shortly = speed_over(source, frame, foot, end, 1);
  return half <= 1 ? shortly : std::min(shortly, speed_over(source, frame, foot, end, half));
}

// one end of one foot
class EndPlanner {
 public:
  EndPlanner(const SourceFeet& source, double standing, double scale, const FitOptions& options,
             int foot, int end, FootPlan& plan)
      : source_(source),
        standing_(standing),
        scale_(scale),
        options_(options),
        foot_(foot),
        end_(end),
        plan_(plan) {}

  void run() {
    const int frames = source_.frame_count();
    std::vector<char> planted(static_cast<std::size_t>(frames) + 1, 0);
    bool on = false;
    for (int frame = 0; frame < frames; ++frame) {
      const SourceFoot& source = source_.at(frame, foot_);
      const double height = end_of(source, end_).z() - standing_;
      goal(frame).clearance =
          std::max(0.0, scale_ * height) + kHalfWidth * scale_ * std::abs(source.side);
      on = stays(frame, height, on);
      planted[static_cast<std::size_t>(frame)] = on ? 1 : 0;
    }
    int begin = 0;
    for (int frame = 0; frame <= frames; ++frame) {
      const bool now = planted[static_cast<std::size_t>(frame)] != 0;
      const bool before = frame > 0 && planted[static_cast<std::size_t>(frame) - 1] != 0;
      if (now && !before) begin = frame;
      if (!now && before) add_phase(begin, frame);
    }
    smooth_levels();
  }

 private:
  FootEndGoal& goal(int frame) {
    const std::size_t row =
        static_cast<std::size_t>(frame) * static_cast<std::size_t>(plan_.foot_count);
    return plan_.ends[2 * (row + static_cast<std::size_t>(foot_)) + static_cast<std::size_t>(end_)];
  }

  [[nodiscard]] bool stays(int frame, double height, bool on) const {
    const double size = source_.leg_length / kLeg;
    const double fast = on ? options_.contact_release_speed : options_.contact_speed;
    const double high = on ? options_.contact_release_height : options_.contact_height;
    return height <= high * size && speed(source_, frame, foot_, end_) <= fast * size;
  }

  void add_phase(int begin, int end) {
    if ((end - begin) * source_.frame_time < options_.contact_time - 1e-9) return;
    for (int frame = begin; frame < end; ++frame) {
      const SourceFoot& source = source_.at(frame, foot_);
      FootEndGoal& g = goal(frame);
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
  int foot_;
  int end_;
  FootPlan& plan_;
};

// While all feet are in the air nothing but their clearance says how high the body flies. What
// lasts longer stands on something.
void stress_flights(int frames, double frame_time, FootPlan& plan) {
  constexpr double kAloft = 0.02, kWholly = 0.05;  // metres
  constexpr double kLongestFlight = 1.0;           // seconds
  constexpr double kImportance = 4.0;
  const std::size_t ends = 2 * static_cast<std::size_t>(plan.foot_count);
  const auto at_frame = [&](int frame) {
    return std::span(plan.ends.data() + static_cast<std::size_t>(frame) * ends, ends);
  };
  const auto lowest = [&](int frame) {
    return std::ranges::min(at_frame(frame), {}, &FootEndGoal::clearance).clearance;
  };
  for (int begin = 0; begin < frames;) {
    int end = begin;
    while (end < frames && lowest(end) > kAloft) ++end;
    for (int frame = begin; frame < end && (end - begin) * frame_time <= kLongestFlight; ++frame) {
      const double share = std::min(1.0, (lowest(frame) - kAloft) / (kWholly - kAloft));
      for (FootEndGoal& goal : at_frame(frame)) goal.importance = 1.0 + share * (kImportance - 1.0);
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

StandingHeights find_standing_heights(const SourceFeet& source, const FitOptions& options) {
  StandingHeights result;
  const int frames = source.frame_count();
  if (frames == 0) return result;
  const double size = source.leg_length / kLeg;
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
  std::vector<double> ankles, toes;
  for (int frame = 0; frame < frames; ++frame) {
    for (int foot = 0; foot < source.foot_count; ++foot) {
      const SourceFoot& now = source.at(frame, foot);
      const double steep = (now.ankle.z() - now.toe.z()) / (now.ankle - now.toe).norm();
      if (now.toe.z() < floor + kNearLowest * size && steep > kFlattestFoot &&
          steep < kSteepestFoot &&
          speed(source, frame, foot, kHeel) < options.contact_speed * size &&
          speed(source, frame, foot, kToe) < options.contact_speed * size) {
        ankles.push_back(now.ankle.z());
        toes.push_back(now.toe.z());
      }
    }
  }
  if (static_cast<double>(ankles.size()) * source.frame_time > kLeastStanding) {
    return {median(ankles), median(toes), true};
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
  for (int foot = 0; foot < source.foot_count; ++foot) {
    EndPlanner(source, standing.ankle, scale, options, foot, kHeel, plan).run();
    EndPlanner(source, standing.toe, scale, options, foot, kToe, plan).run();
  }
  if (plan.foot_count > 0) stress_flights(source.frame_count(), source.frame_time, plan);
  return plan;
}

}  // namespace retarget
