// Finds the heights at which a human's feet stand on the floor.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

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
constexpr double kShortestStay = 0.2;  // Seconds for which a foot stands at least once.

// Heights above the floor to which the joints of lying and crawling bodies sink, metres. Elbows of
// motion capture data are often below the floor. In the order of kSupportBones and kUpperBones.
constexpr std::array kSunkSupports = {0.03, 0.03, -0.02, -0.02, 0.0, 0.0, 0.06, 0.06};
constexpr std::array kSunkUppers = {0.04, 0.04, 0.05};
static_assert(kSunkSupports.size() == kSupportBones.size());
static_assert(kSunkUppers.size() == kUpperBones.size());

// Height of the lower foot's end; infinite if no foot has this end.
double lower_end(const SourceFeet& source, int frame, int end) {
  double z = HUGE_VAL;
  for (int foot = 0; foot < source.foot_count; ++foot) {
    if (source.has(foot, end)) z = std::min(z, source.at(frame, foot).end(end).z());
  }
  return z;
}

// Height of the floor on which the lowest part of the body other than the feet rests in this frame;
// infinite if no such part is known.
double floor_below_parts(const SourceFeet& source, int frame, double size) {
  constexpr double kPalm = 0.06;  // Height of the wrist above the palm of such a hand, metres.
  double hands = HUGE_VAL, elbows = HUGE_VAL, others = HUGE_VAL;
  for (std::size_t i = 0; i < kSupportBones.size() && !source.supports.empty(); ++i) {
    if (!source.has_support[i]) continue;
    const std::optional<LimbBone> part = limb_bone(kSupportBones[i]);
    double& z = part == LimbBone::kHand ? hands : part == LimbBone::kForeArm ? elbows : others;
    z = std::min(z, source.support(frame, i).z() - kSunkSupports[i] * size);
  }
  for (std::size_t i = 0; i < kUpperBones.size() && !source.uppers.empty(); ++i) {
    if (!source.has_upper[i]) continue;
    others = std::min(others, source.upper(frame, i).z() - kSunkUppers[i] * size);
  }
  if (others > hands + kAloft * size) hands -= kPalm * size;
  return std::min({hands, elbows, others});
}

// Height of the toe of a standing foot above the floor, which known soles touch.
double toe_over_floor(const SourceFeet& source, double size) {
  return source.soles[0] || source.soles[1] ? 0.0 : kToeHeight * size;
}

// Whether the knee above a foot is about as low as the ankle. The feet of kneeling and crawling
// bodies often have the pitch of standing feet, but rest on their tips, or lie in the air.
bool is_kneeling(const SourceFeet& source, int frame, int foot, double size) {
  constexpr double kShank = 0.12;  // Least height of the knee above the ankle, metres.
  const auto knee = static_cast<std::size_t>(foot);
  static_assert(kSupportBones[0] == Bone::kLeftLeg && kSupportBones[1] == Bone::kRightLeg);
  if (source.supports.empty() || !source.has_support[knee]) return false;
  return source.support(frame, knee).z() - source.at(frame, foot).ankle.z() < kShank * size;
}

// Whether the toes are below this height only for a moment, and the body gets there faster than it
// can fall: its position was lost.
bool is_lost_below(const SourceFeet& source, double height, double size) {
  constexpr double kFall = 6.0;  // m/s, from a height of 1.8 m.
  const double farthest = kSunk * size + kFall * source.frame_time;
  double seconds = 0.0, last = lower_end(source, 0, kToeEnd);
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    const double now = lower_end(source, frame, kToeEnd);
    if (now < height) {
      if (last >= height && last - now < farthest) return false;
      seconds += source.frame_time;
    }
    last = now;
  }
  return seconds <= kMinStanding;
}

// Whether the toes are above this height at the beginning and the end of the clip. A clip that
// begins or ends lower may begin before a step up or end with a step down.
bool is_above_at_ends(const SourceFeet& source, double height) {
  return lower_end(source, 0, kToeEnd) > height &&
         lower_end(source, source.frame_count() - 1, kToeEnd) > height;
}

// Whether a foot was stopped before this frame: it fell, and then stands. In a dip of the root,
// feet slow down gradually.
bool is_stopped(const SourceFeet& source, int foot, int frame, double size) {
  constexpr double kFall = 1.5, kStill = 0.3;  // m/s
  const auto fall = [&](int to) {
    const int last = source.frame_count() - 1;
    const auto toe = [&](int at) { return source.at(std::clamp(at, 0, last), foot).toe.z(); };
    return (toe(to - 1) - toe(to)) / (size * source.frame_time);
  };
  return std::max(fall(frame - 1), fall(frame)) > kFall && std::abs(fall(frame + 1)) < kStill;
}

}  // namespace

double floor_below_lowest(const SourceFeet& source, int frame, double scale) {
  const double toe = toe_over_floor(source, scale);
  const double ankle = toe + (source.ankle_over_heel() > 0.0 ? 0.0 : kUsualRise * scale);
  return std::min({lower_end(source, frame, kToeEnd) - toe,
                   lower_end(source, frame, kHeelEnd) - ankle,
                   floor_below_parts(source, frame, scale)});
}

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
        slow_.push_back({frame, foot, now.end(kHeelEnd).z(), now.toe.z(), now.sole_up > kSoleUp});
      }
    }
  }
}

// Sorted by toe height.
void StandingHeightFinder::find_feet_that_stand(const SourceFeet& source, double speed,
                                                double size) {
  find_slow_feet(source, speed, [](const SourceFoot& foot) {
    const double steep = foot.steepness();
    return steep > kFlattestFoot && steep < kMaxFootPitch;
  });
  std::erase_if(slow_, [&](const StandingFoot& foot) {
    return is_kneeling(source, foot.frame, foot.foot, size);
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

bool StandingHeightFinder::carries(Feet level, double frame_time) {
  return static_cast<double>(level.size()) * frame_time > kMinStanding;
}

// Whether feet stand at this level only once and for a small share of the standing time: a body
// that sinks after a flip, or lost markers.
bool StandingHeightFinder::is_a_moment(Feet level, std::size_t standing, double frame_time) {
  constexpr double kLittle = 0.1;
  if (level.empty()) return false;
  if (static_cast<double>(level.size()) >= kLittle * static_cast<double>(standing)) return false;
  const auto [first, last] = std::ranges::minmax(level, {}, &StandingFoot::frame);
  return (last.frame - first.frame) * frame_time <= kMinStanding;
}

// Whether no foot stays at this level: at the lowest point of a dip, feet are slow, but not for
// long.
bool StandingHeightFinder::is_only_passed(Feet level, const SourceFeet& source, double size) {
  const double frame_time = source.frame_time;
  if (carries(level, frame_time)) return false;
  const auto has = [&](int foot, int frame) {
    return std::ranges::any_of(level, [&](const StandingFoot& other) {
      return other.foot == foot && other.frame == frame;
    });
  };
  return std::ranges::none_of(level, [&](const StandingFoot& first) {
    if (has(first.foot, first.frame - 1)) return false;
    if (is_stopped(source, first.foot, first.frame, size)) return true;
    int frames = 1;
    while (has(first.foot, first.frame + frames)) ++frames;
    return frames * frame_time >= kShortestStay;
  });
}

// Returns the feet that stand on the floor: those of the lowest level, up to kNearLowest above the
// lowest toes. If that level is only a moment or a dip, returns the next level with standing feet;
// otherwise all other feet would stand in the air. That level is near, unless the position of the
// body was lost meanwhile.
StandingHeightFinder::Feet StandingHeightFinder::feet_on_floor(const SourceFeet& source,
                                                               double lowest, double size) {
  const double band = kNearLowest * size;
  auto level = between(slow_, -HUGE_VAL, lowest + band);
  const bool moment = is_a_moment(level, slow_.size(), source.frame_time);
  if (!moment && !is_only_passed(level, source, size)) return level;
  if (!moment) {
    // The upper foot of a body that lies on its side does not stand.
    std::erase_if(slow_, [](const StandingFoot& foot) { return !foot.upright; });
    level = between(slow_, -HUGE_VAL, lowest + band);
  }
  for (const StandingFoot& foot : Feet(slow_).subspan(level.size())) {
    const bool is_near = foot.toe <= lowest + kSunk * size;
    const auto higher = between(slow_, foot.toe, foot.toe + band);
    if (!carries(higher, source.frame_time)) continue;
    if (is_a_moment(higher, slow_.size(), source.frame_time)) continue;
    if (moment && is_near) return higher;
    const bool lost = is_near || is_lost_below(source, foot.toe - kSunk * size, size);
    return lost && is_above_at_ends(source, foot.toe - band) ? higher : level;
  }
  return level;
}

// Low percentile of the height of the lower foot's end; infinite if no foot has this end.
double StandingHeightFinder::low_height(const SourceFeet& source, int end) {
  std::vector<double>& lowest = values_;
  lowest.clear();
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    lowest.push_back(lower_end(source, frame, end));
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

// Returns the height of the floor on which a part other than the feet rests, if feet whose lowest
// toes have this height are above that floor: those of a handstand or of a lying body.
std::optional<double> StandingHeightFinder::floor_below_body(const SourceFeet& source, double toe,
                                                             double size) {
  constexpr double kRestingShare = 0.2;  // Share of the frames.
  // In most files the floor is at z = 0. It is there if the lowest parts are higher or lower by less
  // than this, metres.
  constexpr double kOverZero = 0.1, kUnderZero = 0.07;
  // Least height of the feet above the floor, metres. Parts of some bodies sink by 6 cm more than
  // those of others, so a floor that is not at zero is less certain.
  constexpr double kOverFloor = 0.01, kFarOverFloor = 0.08;
  const double toe_height = toe_over_floor(source, size);
  std::vector<double>& lowest = values_;
  lowest.clear();
  int on_feet = 0;
  for (int frame = 0; frame < source.frame_count(); ++frame) {
    const double toes = lower_end(source, frame, kToeEnd), under_toes = toes - toe_height;
    const double parts = floor_below_parts(source, frame, size);
    lowest.push_back(std::min(under_toes, parts));
    if (under_toes <= parts && toes < toe + kNearLowest * size) ++on_feet;
  }
  const auto low =
      lowest.begin() + static_cast<std::ptrdiff_t>(kRestingShare * source.frame_count());
  std::ranges::nth_element(lowest, low);
  const bool at_zero = -kUnderZero * size < *low && *low < kOverZero * size;
  const double highest = toe - toe_height - (at_zero ? kOverFloor : kFarOverFloor) * size;
  if (!(*low < highest)) return std::nullopt;
  if (at_zero) return 0.0;
  // Feet that carry the body for a while are on the floor, although not with the pitch of standing.
  return on_feet * source.frame_time > kMinStanding ? std::nullopt : std::optional(*low);
}

// Heights of the ends of feet. With a known sole, the heel replaces the ankle.
StandingHeights StandingHeightFinder::heights_of_ends(const SourceFeet& source, double size,
                                                      const ContactOptions& options) {
  const double low_toe = low_height(source, kToeEnd);
  const bool has_toes = !std::isinf(low_toe);
  if (has_toes) {
    find_feet_that_stand(source, options.begin_speed * size, size);
    const auto level = feet_on_floor(source, low_toe, size);
    if (carries(level, source.frame_time)) {
      return {middle_height(level, &StandingFoot::ankle), middle_height(level, &StandingFoot::toe),
              true};
    }
  }
  const double low_ankle = has_toes ? 0.0 : low_height(source, kHeelEnd);
  const double lowest = has_toes ? low_toe : low_ankle - kUsualRise * size;
  const auto floor = floor_below_body(source, lowest, size);
  const double toe = floor ? *floor + toe_over_floor(source, size) : lowest;
  StandingHeights heights{toe, toe, false};
  heights.from_body = floor.has_value();
  if (!has_toes) {
    heights.ankle = floor ? toe + kUsualRise * size : low_ankle;
  } else if (!source.soles[0] && !source.soles[1]) {  // A sole is flat.
    heights.ankle += guessed_rise(source, toe, size, options);
  }
  return heights;
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
