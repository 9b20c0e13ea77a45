#include "human/gait/root_drift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/math/banded_system.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr int kEndCount = 4;  // Left heel, left toe, right heel, right toe.

double square(double x) {
  return x * x;
}

// Tracks of the ends of both feet, scaled to a body of the usual size.
struct EndTracks {
  explicit EndTracks(const SourceFeet& feet) : frame_time(feet.frame_time) {
    const double leg = feet.leg_length();
    scale = leg > 0.0 ? leg / kUsualSourceLeg : 1.0;
    count = static_cast<std::size_t>(feet.frame_count());
    for (int end = 0; end < kEndCount; ++end) {
      auto& track = places[end];
      track.reserve(count);
      for (int frame = 0; frame < feet.frame_count(); ++frame) {
        track.push_back(feet.at(frame, end / 2).end(end % 2) / scale);
      }
    }
    for (int foot = 0; foot < 2; ++foot) level_heel(feet, foot);
    lowest.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      lowest[i] = std::min(lower(0, i), lower(1, i));
    }
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i < count; ++i) velocities[end].push_back(velocity_of(end, i));
    }
  }

  [[nodiscard]] double lower(int foot, std::size_t i) const {
    return std::min(heights[2 * foot][i], heights[2 * foot + 1][i]);
  }
  [[nodiscard]] Vector3d velocity(int foot, std::size_t i) const {
    return 0.5 * (velocities[2 * foot][i] + velocities[2 * foot + 1][i]);
  }
  // Speed at which a foot turns, as the speed of one end about the other.
  [[nodiscard]] double turning(int foot, std::size_t i) const {
    return (velocities[2 * foot][i] - velocities[2 * foot + 1][i]).norm();
  }

  double frame_time, scale = 1.0;
  std::size_t count = 0;
  std::array<std::vector<Vector3d>, kEndCount> places, velocities;
  std::array<std::vector<double>, kEndCount>
      heights;  // Heels are shifted to the height of the toes of a flat foot.
  std::vector<double> lowest;

 private:
  void level_heel(const SourceFeet& feet, int foot) {
    std::vector<double> rises, all;
    for (std::size_t i = 0; i < count; ++i) {
      const double rise = places[2 * foot][i].z() - places[2 * foot + 1][i].z();
      all.push_back(rise);
      constexpr double kLevel = 0.9;
      if (feet.at(static_cast<int>(i), foot).sole_up > kLevel) rises.push_back(rise);
    }
    const double rise = rises.empty() ? median(all) : median(rises);
    for (std::size_t i = 0; i < count; ++i) {
      heights[2 * foot].push_back(places[2 * foot][i].z() - rise);
      heights[2 * foot + 1].push_back(places[2 * foot + 1][i].z());
    }
  }

  // Over 1/15 s, as for contact speeds.
  [[nodiscard]] Vector3d velocity_of(int end, std::size_t i) const {
    const auto half = static_cast<std::size_t>(std::max(1L, std::lround(0.5 / 15.0 / frame_time)));
    const std::size_t from = i < half ? 0 : i - half, to = std::min(i + half, count - 1);
    if (to == from) return Vector3d::Zero();
    return (places[end][to] - places[end][from]) / (frame_time * static_cast<double>(to - from));
  }
};

bool has_whole_feet(const SourceFeet& feet) {
  return feet.foot_count == 2 && feet.has_ankle[0] && feet.has_ankle[1] && feet.has_toe[0] &&
         feet.has_toe[1] && feet.frame_count() >= 3;
}

// Whether the hips are high above the lowest foot, as in standing or squatting. The feet of a lying
// body do not stand.
bool is_upright(const SourceFeet& feet, const EndTracks& tracks, std::size_t i) {
  constexpr double kHips = 0.3;  // Metres.
  return i >= feet.hips.size() || feet.hips[i] / tracks.scale - tracks.lowest[i] > kHips;
}

// Whether the standing feet climb in each third of the clip, and the lowest foot as far as they do.
bool is_steady(const EndTracks& tracks, const std::vector<double>& climbing, double climb) {
  // `climbing` is NaN in frames without a standing foot.
  constexpr std::size_t kParts = 3;
  std::array<double, kParts> lowest{};
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t begin = tracks.count * part / kParts,
                      end = tracks.count * (part + 1) / kParts;
    std::vector<double> speeds;
    for (std::size_t i = begin; i < end; ++i) {
      if (std::isfinite(climbing[i])) speeds.push_back(climbing[i]);
    }
    const double duration = static_cast<double>(tracks.count) * tracks.frame_time;
    if (speeds.empty() || !(median(speeds) * duration / climb > 0.4)) return false;
    lowest[part] = percentile({tracks.lowest.begin() + static_cast<std::ptrdiff_t>(begin),
                               tracks.lowest.begin() + static_cast<std::ptrdiff_t>(end)},
                              20.0);
  }
  // From the middle of the first third to the middle of the last one.
  const double seen = (lowest.back() - lowest.front()) / climb;
  return seen > 0.4 && seen < 1.0;
}

constexpr double kClimbSpeed = 0.03;  // m/s
constexpr double kClimb = 0.05;       // Metres.
constexpr double kMuchLess = 0.6;

}  // namespace

bool RootEvidence::moves() const {
  constexpr double kSpeed = 0.1, kTime = 0.4;
  constexpr double kSingleSpeed = 0.3, kLongSingleSpeed = 0.2, kLongTime = 1.5;
  constexpr double kClimbTime = 1.0;
  if (climbs_steadily && std::abs(climb) > kClimb) return true;
  // Standing feet hardly move vertically, so a lower speed is certain.
  if (climb_seconds > kClimbTime && shake_speed > kClimbSpeed) return true;
  // Evidence from both feet is more reliable.
  if (seconds > kTime && speed > kSpeed) return true;
  if (single_seconds > kLongTime) return single_speed > kLongSingleSpeed;
  return seconds <= kTime && single_seconds > kTime && single_speed > kSingleSpeed;
}

bool RootEvidence::climbs() const {
  return climbs_steadily || climb_speed > kClimbSpeed;
}

RootEvidence measure_root(const SourceFeet& feet) {
  // Largest turning speed of a standing foot and speed difference of the feet, m/s; height
  // differences, metres.
  constexpr double kSame = 0.12, kLevel = 0.05, kLower = 0.03;
  RootEvidence evidence;
  if (!has_whole_feet(feet)) return evidence;
  const EndTracks tracks(feet);
  std::vector<double> speeds, single_speeds, climbing(tracks.count, NAN), climbs;
  for (std::size_t i = 0; i < tracks.count; ++i) {
    const bool upright = is_upright(feet, tracks, i);
    const std::array<bool, 2> steady = {tracks.turning(0, i) < kSame, tracks.turning(1, i) < kSame};
    const bool same = (tracks.velocity(0, i) - tracks.velocity(1, i)).norm() < kSame;
    const double over = tracks.lower(0, i) - tracks.lower(1, i);
    if (steady[0] && steady[1] && same && std::abs(over) < kLevel) {
      const Vector3d velocity = 0.5 * (tracks.velocity(0, i) + tracks.velocity(1, i));
      if (upright) speeds.push_back(velocity.norm());
      climbing[i] = velocity.z();
      climbs.push_back(velocity.z());
    } else if (!same && std::abs(over) > kLower) {
      const int foot = over < 0.0 ? 0 : 1;
      if (!steady[foot]) continue;
      if (upright) single_speeds.push_back(tracks.velocity(foot, i).norm());
      climbing[i] = tracks.velocity(foot, i).z();
    }
  }
  const auto seconds = [&](const std::vector<double>& values) {
    return static_cast<double>(values.size()) * tracks.frame_time;
  };
  evidence.seconds = seconds(speeds);
  evidence.single_seconds = seconds(single_speeds);
  // Feet also move during jumps, but not for most of the time.
  constexpr double kUsual = 35.0;  // Percent.
  if (!speeds.empty()) evidence.speed = percentile(speeds, kUsual);
  if (!single_speeds.empty()) evidence.single_speed = percentile(single_speeds, kUsual);
  if (!climbs.empty()) {
    evidence.climb = median(climbs) * static_cast<double>(tracks.count) * tracks.frame_time;
    evidence.climbs_steadily = evidence.climb != 0.0 && is_steady(tracks, climbing, evidence.climb);
  }
  std::erase_if(climbing, [](double speed) { return !std::isfinite(speed); });
  evidence.climb_seconds = seconds(climbing);
  if (!climbing.empty()) {
    const auto exceeded = [&](double middle) {
      std::vector<double> off;
      for (const double speed : climbing) off.push_back(std::abs(speed - middle));
      return percentile(off, kUsual);
    };
    evidence.climb_speed = exceeded(0.0);
    evidence.shake_speed = exceeded(median(climbing));
  }
  return evidence;
}

bool root_is_missing(const SourceFeet& feet, const std::vector<Vector3d>& hips) {
  constexpr double kSpeed = 0.25 * kUsualSourceLeg;  // m/s
  if (!has_whole_feet(feet)) return false;
  const EndTracks tracks(feet);
  double slowest = 0.0, root = 0.0;
  for (std::size_t i = 0; i + 1 < tracks.count; ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& places : tracks.places) {
      least = std::min(least, (places[i + 1] - places[i]).norm());
    }
    slowest += least;
    root += (hips[i + 1] - hips[i]).norm() / tracks.scale;
  }
  const double seconds = static_cast<double>(tracks.count - 1) * tracks.frame_time;
  return root < kSpeed * seconds && slowest > kSpeed * seconds && slowest > root;
}

namespace {

// Iteratively reweighted least squares.
class DriftSolver {
 public:
  DriftSolver(const SourceFeet& feet, const std::vector<Vector3d>& hips, DriftRule rule)
      : tracks_(feet),
        vertical_(rule.vertical),
        rate_(1.0 / tracks_.frame_time),
        turning_(rule.jittery ? 0.2 : 0.12),
        step_((rule.jittery ? 0.15 : 0.05) * tracks_.frame_time),
        drift_(tracks_.count, Vector3d::Zero()) {
    for (const Vector3d& place : hips) hips_.push_back(place / tracks_.scale);
    find_stances();
    find_common_steps();
  }

  RootDrift solve() {
    // Distance from the common level, in metres, at which a stance weighs a quarter; 0: ignore the
    // level.
    constexpr std::array kGates = {0.0, 0.0, 0.3, 0.2, 0.12, 0.08, 0.08};
    RootDrift result;
    result.speed_before = speed_of_stances() * tracks_.scale;
    result.climb_before = climb_of_stances() * tracks_.scale;
    for (const double gate : kGates) {
      weigh_steps();
      for (int axis = 0; axis < (vertical_ ? 3 : 2); ++axis) solve_axis(axis, gate);
      is_first_ = false;
    }
    result.speed_after = speed_of_stances() * tracks_.scale;
    result.climb_after = climb_of_stances() * tracks_.scale;
    Vector3d middle;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const Vector3d& drift : drift_) values.push_back(drift[axis]);
      middle[axis] = median(values);
    }
    for (const Vector3d& drift : drift_) {
      result.drift.push_back(drift * tracks_.scale);
      result.farthest = std::max(result.farthest, (drift - middle).norm() * tracks_.scale);
    }
    return result;
  }

 private:
  // Likelihood that each end stands, from quantities that do not depend on the root.
  void find_stances() {
    constexpr double kFree = 0.02, kWidth = 0.03, kEndFree = 0.005, kEndWidth = 0.015;
    // Only the lower end of a turning foot may stand, with a lower likelihood.
    constexpr double kTurningShare = 0.1;
    const std::vector<char> aloft = frames_aloft();
    for (int end = 0; end < kEndCount; ++end) {
      stands_[end].assign(tracks_.count, 0.0);
      for (std::size_t i = 0; i < tracks_.count; ++i) {
        if (aloft[i]) continue;
        const int foot = end / 2;
        const double lower = tracks_.lower(foot, i);
        const double near = bell(std::max(0.0, lower - tracks_.lowest[i] - kFree) / kWidth);
        const double steady = bell(tracks_.turning(foot, i) / turning_);
        const double rise = std::max(0.0, tracks_.heights[end][i] - lower - kEndFree);
        stands_[end][i] = near * (steady + (1.0 - steady) * kTurningShare * bell(rise / kEndWidth));
      }
    }
  }

  // Frames in which the lowest foot is far above its level within a second: the body is in the air.
  [[nodiscard]] std::vector<char> frames_aloft() const {
    constexpr double kJump = 0.12, kMaxSpread = 0.1;
    const double middle = median(tracks_.lowest);
    std::vector<double> off;
    for (const double height : tracks_.lowest) off.push_back(std::abs(height - middle));
    const double high = kJump + 2.0 * std::min(1.48 * median(off), kMaxSpread);
    const auto reach = static_cast<std::size_t>(std::lround(rate_));
    std::vector<char> aloft(tracks_.count, 0);
    for (std::size_t i = 0; i < tracks_.count; ++i) {
      const std::size_t from = i < reach ? 0 : i - reach;
      const std::size_t to = std::min(i + reach + 1, tracks_.count);
      const double floor = percentile({tracks_.lowest.begin() + static_cast<std::ptrdiff_t>(from),
                                       tracks_.lowest.begin() + static_cast<std::ptrdiff_t>(to)},
                                      10.0);
      aloft[i] = tracks_.lowest[i] - floor > high ? 1 : 0;
    }
    return aloft;
  }

  [[nodiscard]] Vector3d step(int end, std::size_t i) const {
    return tracks_.places[end][i + 1] - tracks_.places[end][i];
  }
  [[nodiscard]] double stands(int end, std::size_t i) const {
    return std::min(stands_[end][i], stands_[end][i + 1]);
  }

  // Common step of the standing ends, and its RMS change from frame to frame.
  void find_common_steps() {
    constexpr double kSure = 0.8, kLeastChange = 0.5;  // m/s^2
    Vector3d squares = Vector3d::Zero();
    int changes = 0;
    bool was_sure = false;
    for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
      Vector3d sum = Vector3d::Zero();
      double weight = 0.0;
      for (int end = 0; end < kEndCount; ++end) {
        sum += stands(end, i) * step(end, i);
        weight += stands(end, i);
      }
      common_.push_back(sum / std::max(weight, 1e-9));
      const bool sure = weight > kSure;
      if (sure && was_sure) {
        squares += (common_[i] - common_[i - 1]).cwiseAbs2();
        ++changes;
      }
      was_sure = sure;
    }
    const double least = kLeastChange * square(tracks_.frame_time);
    if (changes > 0) squares /= changes;
    change_ = squares.cwiseSqrt().cwiseMax(least);
  }

  // Reduces the weight of ends that move differently from the solution: they do not stand.
  void weigh_steps() {
    constexpr double kFirstWidth = 0.5, kWidth = 0.2;  // m/s
    for (int end = 0; end < kEndCount; ++end) {
      weights_[end].resize(tracks_.count - 1);
      for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
        const Vector3d expected = is_first_ ? common_[i] : Vector3d(drift_[i + 1] - drift_[i]);
        const double off = (step(end, i) - expected).norm() * rate_;
        weights_[end][i] = stands(end, i) * (is_first_ ? 1.0 / (1.0 + square(off / kFirstWidth))
                                                       : cauchy(off / kWidth));
      }
    }
  }

  void solve_axis(int axis, double gate) {
    // Acceleration of the hips in m/s^2, and root offset in metres over about a second.
    constexpr double kHipsChange = 6.0, kAside = 0.15, kUpward = 0.5;
    PentadiagonalFit fit(tracks_.count);
    const double hips = 1.0 / square(kHipsChange * square(tracks_.frame_time));
    const double smooth = 1.0 / square(change_[axis]);
    for (std::size_t i = 0; i + 2 < tracks_.count; ++i) {
      const double bend = hips_[i][axis] - 2.0 * hips_[i + 1][axis] + hips_[i + 2][axis];
      fit.add_second_difference(i, hips, bend);
      fit.add_second_difference(i, smooth, 0.0);
    }
    const double near = 1.0 / (square(axis < 2 ? kAside : kUpward) * rate_);
    for (std::size_t i = 0; i < tracks_.count; ++i) fit.add_value(i, near, 0.0);
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
        fit.add_difference(i, weights_[end][i] / square(step_), step(end, i)[axis]);
      }
    }
    if (axis == 2 && gate > 0.0) add_level(gate, fit);
    const std::vector<double> solved = fit.solve();
    for (std::size_t i = 0; i < tracks_.count; ++i) drift_[i][axis] = solved[i];
  }

  // Pulls stances to one level, except those far from it, such as on a step or a box.
  void add_level(double gate, PentadiagonalFit& fit) const {
    constexpr double kSpread = 0.03, kTime = 0.3;  // Spread in metres of stances of this duration.
    std::vector<double> standing;
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i < tracks_.count; ++i) {
        if (stands_[end][i] > 0.5) standing.push_back(tracks_.heights[end][i] - drift_[i].z());
      }
    }
    if (standing.empty()) return;
    const double level = median(standing);
    const double weight = 1.0 / (square(kSpread) * kTime * rate_);
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i < tracks_.count; ++i) {
        const double height = tracks_.heights[end][i];
        const double off = (height - drift_[i].z() - level) / gate;
        const double stands = weights_[end][std::min(i, tracks_.count - 2)];
        fit.add_value(i, weight * stands * cauchy(off), height - level);
      }
    }
  }

  [[nodiscard]] double speed_of_stances() const {
    std::vector<double> speeds;
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
        if (stands(end, i) < 0.5) continue;
        speeds.push_back((step(end, i) - drift_[i + 1] + drift_[i]).norm() * rate_);
      }
    }
    return speeds.empty() ? 0.0 : median(speeds);
  }

  [[nodiscard]] double climb_of_stances() const {
    std::vector<double> rises;
    for (int end = 0; end < kEndCount; ++end) {
      for (std::size_t i = 0; i + 1 < tracks_.count; ++i) {
        if (stands(end, i) < 0.5) continue;
        rises.push_back((step(end, i) - drift_[i + 1] + drift_[i]).z());
      }
    }
    return rises.empty() ? 0.0 : median(rises) * static_cast<double>(tracks_.count);
  }

  // Approximately exp(-x^2), bit-identical on every machine.
  static double bell(double x) {
    const double y = x * x;
    return 1.0 / (1.0 + y * (1.0 + y * (0.5 + y / 6.0)));
  }
  static double cauchy(double x) { return 1.0 / square(1.0 + x * x); }

  EndTracks tracks_;
  bool vertical_;
  double rate_;
  double turning_;  // Turning speed above which a foot hardly stands, m/s.
  double step_;     // Movement of a standing end per frame, metres.
  std::vector<Vector3d> drift_, hips_, common_;
  Vector3d change_ = Vector3d::Zero();  // RMS of the drift's second differences.
  std::array<std::vector<double>, kEndCount> stands_, weights_;
  bool is_first_ = true;
};

}  // namespace

bool RootDrift::calms_feet() const {
  return speed_after < kMuchLess * speed_before;
}

bool RootDrift::helps() const {
  const bool climbed = std::abs(climb_before) > kClimb;
  return calms_feet() || (climbed && std::abs(climb_after) < kMuchLess * std::abs(climb_before));
}

RootDrift find_root_drift(const SourceFeet& feet, const std::vector<Vector3d>& hips,
                          DriftRule rule) {
  if (!has_whole_feet(feet)) return {};
  return DriftSolver(feet, hips, rule).solve();
}

}  // namespace retarget
