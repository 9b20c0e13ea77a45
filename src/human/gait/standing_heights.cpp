// Finds the heights at which a human's feet stand on the floor.

#include <algorithm>
#include <cmath>

#include "human/gait/standing_heights.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// Height of the ankle above the toe, per distance between them, of a standing foot.
constexpr double kFlattestFoot = 0.15, kMaxFootPitch = 0.6, kCommonFoot = 0.36;
constexpr double kUsualRise = 0.06;    // The same in metres.
constexpr double kNearLowest = 0.05;   // Metres.
constexpr double kLowestShare = 0.02;  // Share of the frames.
constexpr double kMinStanding = 0.7;   // Seconds, summed over both feet.
constexpr double kSunk = 0.25;         // Metres by which a body may briefly be too low.

}  // namespace

// Collects slow feet with toes that satisfy `is_like_standing`.
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

// Sorted by toe height.
void StandingHeightFinder::find_feet_that_stand(const SourceFeet& source, double speed) {
  find_slow_feet(source, speed, [](const SourceFoot& foot) {
    const double steep = foot.steepness();
    return steep > kFlattestFoot && steep < kMaxFootPitch;
  });
  // Ties need no order: callers take all feet with equal toe heights or none.
  std::ranges::sort(slow_, {}, &StandingFoot::toe);
}

// Sorted feet with toe heights in [from, to).
StandingHeightFinder::Feet StandingHeightFinder::between(Feet standing, double from, double to) {
  const auto begin = std::ranges::lower_bound(standing, from, {}, &StandingFoot::toe);
  const auto end = std::ranges::lower_bound(begin, standing.end(), to, {}, &StandingFoot::toe);
  return {begin, end};
}

// Whether feet stand at this level only once and for a small share of the standing time: a body
// that sinks after a flip, or lost markers.
bool StandingHeightFinder::is_a_moment(Feet level, std::size_t standing, double frame_time) {
  constexpr double kLittle = 0.1;
  if (static_cast<double>(level.size()) >= kLittle * static_cast<double>(standing)) return false;
  const auto [first, last] = std::ranges::minmax(level, {}, &StandingFoot::frame);
  return (last.frame - first.frame) * frame_time <= kMinStanding;
}

// Returns the feet that stand on the floor: those of the lowest level, up to `band` above the
// lowest toes. If that level is only a moment and another level with standing feet is near, returns
// the latter; otherwise all other feet would stand in the air.
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

// Low percentile of the height of the lower foot's end; infinite if no foot has this end.
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

// Height of ankles above toes if few feet have the usual pitch of standing feet: from feet that
// stand otherwise, as in high heels, or a guess.
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

// Heights of the ends of feet. With a known sole, the heel replaces the ankle.
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
  // A sole is flat.
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
