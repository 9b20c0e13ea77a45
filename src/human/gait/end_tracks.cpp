#include "human/gait/end_tracks.h"

#include <algorithm>
#include <cmath>

#include "retarget/statistics.h"

namespace retarget {

using Eigen::Vector3d;

EndTracks::EndTracks(const SourceFeet& feet) : frame_time(feet.frame_time) {
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

double EndTracks::lower(int foot, std::size_t i) const {
  return std::min(heights[2 * foot][i], heights[2 * foot + 1][i]);
}

void EndTracks::level_heel(const SourceFeet& feet, int foot) {
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
Vector3d EndTracks::velocity_of(int end, std::size_t i) const {
  const auto half = static_cast<std::size_t>(std::max(1L, std::lround(0.5 / 15.0 / frame_time)));
  const std::size_t from = i < half ? 0 : i - half, to = std::min(i + half, count - 1);
  if (to == from) return Vector3d::Zero();
  return (places[end][to] - places[end][from]) / (frame_time * static_cast<double>(to - from));
}

bool has_whole_feet(const SourceFeet& feet) {
  return feet.foot_count == 2 && feet.has_ankle[0] && feet.has_ankle[1] && feet.has_toe[0] &&
         feet.has_toe[1] && feet.frame_count() >= 3;
}

}  // namespace retarget
