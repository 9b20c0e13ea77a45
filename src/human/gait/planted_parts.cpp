#include "human/gait/planted_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "human/gait/frame_runs.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Track = std::vector<Vector3d>;

constexpr double kMoves = 0.2;    // Speed of a part relative to a body that moves past it, m/s.
constexpr double kPlanted = 2.0;  // Greatest speed of a planted part, in usual speeds.

// Velocities between the means of the frames before and after each frame, which noise hardly
// changes.
Track slow_velocities(const Track& places, double frame_time) {
  constexpr double kHalf = 0.15;  // Seconds.
  const int count = static_cast<int>(places.size()), most = frames_in(kHalf, frame_time);
  Track velocities(places.size(), Vector3d::Zero());
  for (int i = 1; i + 1 < count; ++i) {
    const int half = std::min({most, i, count - 1 - i});
    Vector3d moved = Vector3d::Zero();
    for (int k = 1; k <= half; ++k) {
      moved += places[static_cast<std::size_t>(i + k)] - places[static_cast<std::size_t>(i - k)];
    }
    velocities[static_cast<std::size_t>(i)] = moved / (half * (half + 1) * frame_time);
  }
  return velocities;
}

}  // namespace

PlantedParts::PlantedParts(const SourceFeet& feet, const EndTracks& tracks, const Track& hips)
    : frame_time_(tracks.frame_time) {
  constexpr double kUsual = 35.0;       // Percent.
  constexpr double kShortest = 0.5;     // Seconds in which parts move relative to the body.
  constexpr double kLeastSpeed = 0.05;  // m/s; planted feet roll.
  const auto track_of = [&](const auto& place_in) {
    Track track;
    for (std::size_t i = 0; i < tracks.count; ++i) track.push_back(place_in(i));
    return track;
  };
  const Track body = slow_velocities(
      track_of([&](std::size_t i) -> Vector3d { return hips[i] / tracks.scale; }), frame_time_);
  for (std::size_t foot = 0; foot < feet_.size(); ++foot) {
    const auto middle = [&](std::size_t i) -> Vector3d {
      return 0.5 * (tracks.places[2 * foot][i] + tracks.places[2 * foot + 1][i]);
    };
    feet_[foot] = speeds_of(track_of(middle), body);
  }
  std::vector<PartSpeeds> hands;
  for (std::size_t part = 0; part < kSupportBones.size() && !feet.supports.empty(); ++part) {
    const Bone bone = kSupportBones[part];
    if (!feet.has_support[part] || (bone != Bone::kLeftHand && bone != Bone::kRightHand)) continue;
    const auto place = [&](std::size_t i) -> Vector3d {
      return feet.support(static_cast<int>(i), part) / tracks.scale;
    };
    hands.push_back(speeds_of(track_of(place), body));
  }
  const std::vector<double> least = least_speeds(hands);
  std::vector<double> known = least;
  std::erase_if(known, [](double speed) { return !std::isfinite(speed); });
  if (static_cast<double>(known.size()) * frame_time_ < kShortest) return;
  root_speed_ = std::max(kLeastSpeed, percentile(known, kUsual));
  for (const double speed : least) has_planted_.push_back(speed < root_speed_ ? 1 : 0);
}

PlantedParts::PartSpeeds PlantedParts::speeds_of(const Track& places, const Track& body) const {
  constexpr double kStill = 1e-12;
  PartSpeeds speeds;
  const Track velocities = slow_velocities(places, frame_time_);
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    speeds.in_world.push_back(velocities[i].norm());
    speeds.from_body.push_back((velocities[i] - body[i]).norm());
    speeds.with_body.push_back(velocities[i].dot(body[i]) / (body[i].squaredNorm() + kStill));
  }
  return speeds;
}

std::vector<double> PlantedParts::least_speeds(const std::vector<PartSpeeds>& hands) const {
  std::vector<double> least(feet_[0].in_world.size(), std::numeric_limits<double>::infinity());
  const auto add = [&](const PartSpeeds& part) {
    for (std::size_t i = 0; i < least.size(); ++i) {
      if (part.from_body[i] > kMoves) least[i] = std::min(least[i], part.in_world[i]);
    }
  };
  for (const PartSpeeds& foot : feet_) add(foot);
  for (const PartSpeeds& hand : hands) add(hand);
  return least;
}

bool PlantedParts::is_planted(int foot, std::size_t i) const {
  const PartSpeeds& speeds = feet_[static_cast<std::size_t>(foot)];
  return speeds.from_body[i] > kMoves && speeds.in_world[i] < kPlanted * root_speed_;
}

bool PlantedParts::is_carried(int foot, std::size_t i) const {
  // A root of a foreign scale below 3 moves standing feet less than this, or backwards.
  constexpr double kWithBody = 0.7;
  constexpr double kFast = 3.0;  // Usual speeds.
  if (!(root_speed_ > 0.0)) return false;
  const PartSpeeds& speeds = feet_[static_cast<std::size_t>(foot)];
  const double most = (has_planted_[i] != 0 ? kPlanted : kFast) * root_speed_;
  return speeds.in_world[i] > most && speeds.with_body[i] > kWithBody;
}

}  // namespace retarget
