// heights at which the feet of a human stand on the floor

#include "human/standing_heights.h"

#include <algorithm>
#include <cmath>

#include "math/statistics.h"

namespace retarget {
namespace {

// height of the ankle over the toe by their distance, of feet that stand
constexpr double kFlattestFoot = 0.15, kMaxFootPitch = 0.6, kCommonFoot = 0.36;
constexpr double kUsualRise = 0.06;    // the same, metres
constexpr double kNearLowest = 0.05;   // metres
constexpr double kLowestShare = 0.02;  // of frames
constexpr double kMinStanding = 0.7;   // seconds of both feet together
constexpr double kSunk = 0.25;         // metres that a body may be too low for a moment

}  // namespace

// feet with toes that are slow, and as far as `is_like_standing` says
template <typename IsLikeStanding>
void StandingHeightFinder::find_slow_feet(const SourceFeet& source, double speed,
                                          const IsLikeStanding& is_like_standing) {
  slow_.clear();
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    for (int foot = 0; foot < source.foot_count; ++foot) {
      const SourceFoot& now = source.at(frame, foot);
      if (source.has_toe[foot] && is_like_standing(now) &&
          source.speed(frame, foot, kToeEnd) < speed &&
          source.speed(frame, foot, kHeelEnd) < speed) {
        slow_.push_back({frame, now.end(kHeelEnd).z(), now.toe.z()});
      }
    }
  }
}

// by the height of their toes
void StandingHeightFinder::find_feet_that_stand(const SourceFeet& source, double speed) {
  find_slow_feet(source, speed, [](const SourceFoot& foot) {
    const double steep = foot.steepness();
    return steep > kFlattestFoot && steep < kMaxFootPitch;
  });
  // whoever reads it takes all feet with equal toes or none of them
  std::ranges::sort(slow_, {}, &StandingFoot::toe);
}

// those of sorted feet whose toes are in [from, to)
StandingHeightFinder::Feet StandingHeightFinder::between(Feet standing, double from, double to) {
  const auto begin = std::ranges::lower_bound(standing, from, {}, &StandingFoot::toe);
  const auto end = std::ranges::lower_bound(begin, standing.end(), to, {}, &StandingFoot::toe);
  return {begin, end};
}

// Whether feet stand so for one moment alone and for little of the time that they stand at all: a
// body that sinks in behind a flip, or markers that are lost.
bool StandingHeightFinder::is_a_moment(Feet level, std::size_t standing, double frame_time) {
  constexpr double kLittle = 0.1;
  if (static_cast<double>(level.size()) >= kLittle * static_cast<double>(standing)) return false;
  const auto [first, last] = std::ranges::minmax(level, {}, &StandingFoot::frame);
  return (last.frame - first.frame) * frame_time <= kMinStanding;
}

// The feet that stand on the floor: those of the lowest level, up to `band` above the lowest toes,
// unless they do so for a moment and a level on which feet do stand is near. All else would stand
// in the air then.
StandingHeightFinder::Feet StandingHeightFinder::feet_on_floor(Feet standing, double lowest,
                                                               double band, double near,
                                                               double frame_time) {
  const auto level = between(standing, -HUGE_VAL, lowest + band);
  if (level.empty() || !is_a_moment(level, standing.size(), frame_time)) return level;
  for (const StandingFoot& foot : standing.subspan(level.size())) {
    if (foot.toe > lowest + near) break;
    const auto higher = between(standing, foot.toe, foot.toe + band);
    const bool carries = static_cast<double>(higher.size()) * frame_time > kMinStanding;
    if (carries && !is_a_moment(higher, standing.size(), frame_time)) return higher;
  }
  return level;
}

// a low one of the heights by frame of the lower foot's end; infinite without any
double StandingHeightFinder::low_height(const SourceFeet& source, int end) {
  std::vector<double>& lowest = values_;
  lowest.clear();
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    double z = HUGE_VAL;
    for (int foot = 0; foot < source.foot_count; ++foot) {
      if (source.has(foot, end)) z = std::min(z, source.at(frame, foot).end(end).z());
    }
    lowest.push_back(z);
  }
  const auto low =
      lowest.begin() + static_cast<std::ptrdiff_t>(kLowestShare * source.frame_count());
  std::ranges::nth_element(lowest, low);
  return *low;
}

double StandingHeightFinder::middle_height(Feet feet, double StandingFoot::*height) {
  values_.clear();
  for (const StandingFoot& foot : feet) values_.push_back(foot.*height);
  return median_in_place(values_);
}

// how far ankles are over toes where few feet have the usual pitch of standing ones: of feet that
// stand otherwise, as in high heels, or a guess
double StandingHeightFinder::guessed_rise(const SourceFeet& source, double floor, double size,
                                          const ContactOptions& options) {
  find_slow_feet(source, options.begin_speed * size, [&](const SourceFoot& now) {
    return now.sole_up > kSoleUp && now.toe.z() < floor + options.begin_height * size &&
           now.ankle.z() - now.toe.z() > kUprightRise * size;
  });
  values_.clear();
  for (const StandingFoot& foot : slow_) values_.push_back(foot.ankle - foot.toe);
  if (static_cast<double>(values_.size()) * source.frame_time > kMinStanding) {
    return median_in_place(values_);
  }
  const SourceFoot& first = source.at(0, source.has_toe[0] ? 0 : 1);
  return kCommonFoot * (first.ankle - first.toe).norm();
}

// heights of the ends of feet: of soles that are known the heel's in place of the ankle's
StandingHeights StandingHeightFinder::heights_of_ends(const SourceFeet& source, double size,
                                                      const ContactOptions& options) {
  const double floor = low_height(source, kToeEnd);
  if (std::isinf(floor)) {
    const double ankle = low_height(source, kHeelEnd);
    return {ankle, ankle - kUsualRise * size, false};
  }
  find_feet_that_stand(source, options.begin_speed * size);
  const auto level =
      feet_on_floor(slow_, floor, kNearLowest * size, kSunk * size, source.frame_time);
  if (static_cast<double>(level.size()) * source.frame_time > kMinStanding) {
    return {middle_height(level, &StandingFoot::ankle), middle_height(level, &StandingFoot::toe),
            true};
  }
  // a sole is flat
  if (source.soles[0] || source.soles[1]) return {floor, floor, false};
  return {floor + guessed_rise(source, floor, size, options), floor, false};
}

StandingHeights StandingHeightFinder::find(const SourceFeet& source, double scale,
                                           const ContactOptions& options) {
  if (source.frame_count() == 0) return {};
  StandingHeights heights = heights_of_ends(source, scale, options);
  heights.ankle_over_heel = source.ankle_over_heel();
  heights.ankle += heights.ankle_over_heel;
  return heights;
}

void StandingHeightFinder::reserve(int frames) {
  slow_.reserve(2 * static_cast<std::size_t>(frames));
  values_.reserve(2 * static_cast<std::size_t>(frames));
}

StandingHeights find_standing_heights(const SourceFeet& source, const ContactOptions& options) {
  return StandingHeightFinder().find(source, source.leg_length() / kUsualSourceLeg, options);
}

}  // namespace retarget
