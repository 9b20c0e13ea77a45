#include "human/gait/root_drift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "human/gait/end_tracks.h"
#include "human/gait/planted_parts.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Whether the hips are high above the lowest foot, as in standing or squatting. The feet of a lying
// body do not stand.
bool is_upright(const SourceFeet& feet, const EndTracks& tracks, std::size_t i) {
  constexpr double kHips = 0.3;  // Metres.
  return i >= feet.hips.size() || feet.hips[i] / tracks.scale - tracks.lowest[i] > kHips;
}

// Whether the standing feet climb in each third of the clip, and the lowest foot as far as they do.
bool climbs_in_all_thirds(const EndTracks& tracks, const std::vector<double>& climbing,
                          double climb) {
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
  return climbs_steadily || shake_speed > kClimbSpeed;
}

RootEvidence measure_root(const SourceFeet& feet, const std::vector<Vector3d>& hips) {
  // Largest turning speed of a standing foot and speed difference of the feet, m/s; height
  // differences, metres.
  constexpr double kSame = 0.12, kLevel = 0.05, kLower = 0.03;
  RootEvidence evidence;
  if (!has_whole_feet(feet)) return evidence;
  const EndTracks tracks(feet);
  const std::vector<char> falls = frames_in_free_fall(feet, tracks);
  const PlantedParts parts(feet, tracks, hips);
  std::vector<double> speeds, single_speeds, climbing(tracks.count, NAN), climbs;
  for (std::size_t i = 0; i < tracks.count; ++i) {
    if (falls[i] != 0) continue;
    const bool upright = is_upright(feet, tracks, i);
    const auto is_steady = [&](int foot) {
      return tracks.turning(foot, i) < kSame && !parts.is_carried(foot, i);
    };
    const std::array<bool, 2> steady = {is_steady(0), is_steady(1)};
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
    evidence.climbs_steadily =
        evidence.climb != 0.0 && climbs_in_all_thirds(tracks, climbing, evidence.climb);
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
  const double limit =
      kSpeed * static_cast<double>(tracks.count - 1) * tracks.frame_time;  // Metres.
  // @param measured  factors of the axes
  const auto is_missing = [&](const Vector3d& measured) {
    double slowest = 0.0, root = 0.0;
    for (std::size_t i = 0; i + 1 < tracks.count; ++i) {
      double least = std::numeric_limits<double>::infinity();
      for (const auto& places : tracks.places) {
        least = std::min(least, (places[i + 1] - places[i]).cwiseProduct(measured).norm());
      }
      slowest += least;
      root += (hips[i + 1] - hips[i]).cwiseProduct(measured).norm() / tracks.scale;
    }
    return root < limit && slowest > limit && slowest > root;
  };
  // The root of a run may be missing over the ground, and bounce.
  return is_missing(Vector3d::Ones()) || is_missing(Vector3d(1.0, 1.0, 0.0));
}

bool RootDrift::calms_feet() const {
  return speed_after < kMuchLess * speed_before;
}

bool RootDrift::helps() const {
  const bool climbed = std::abs(climb_before) > kClimb;
  return calms_feet() || (climbed && std::abs(climb_after) < kMuchLess * std::abs(climb_before));
}

}  // namespace retarget
