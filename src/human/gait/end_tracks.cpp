#include "human/gait/end_tracks.h"

#include <algorithm>
#include <cmath>

#include "base/math/free_fall.h"
#include "base/math/gravity.h"
#include "retarget/statistics.h"

namespace retarget {

using Eigen::Vector3d;

namespace {

// Frames to either side over which velocities are measured: 1/15 s in total, as for contact speeds.
std::size_t velocity_reach(double frame_time) {
  return static_cast<std::size_t>(std::max(1L, std::lround(0.5 / 15.0 / frame_time)));
}

// Sections of a track in which free fall is looked for. Lengths in frames.
struct FallSections {
  explicit FallSections(double frame_time) {
    constexpr double kRate = 60.0;  // Samples per second, at most.
    stride = static_cast<std::size_t>(std::max(1L, std::lround(1.0 / (kRate * frame_time))));
    step = static_cast<double>(stride) * frame_time;
    reach = static_cast<std::size_t>(free_fall_reach(step));
    length = 2 * reach * stride + 1;
  }

  // Whether the section from a frame follows a parabola of gravity.
  [[nodiscard]] bool falls(const std::vector<double>& heights, std::size_t first) const {
    constexpr double kLeast = 0.75, kMost = 1.25;  // Accelerations of gravity.
    constexpr double kMaxResidual = 0.1;           // Share of the parabola's height.
    std::vector<Vector3d> places;
    for (std::size_t i = first; i < first + length; i += stride) {
      places.emplace_back(0.0, 0.0, heights[i]);
    }
    const Parabola fall = fit_parabola(places, step);
    const double share = -fall.acceleration.z() / kGravity;
    const double time = static_cast<double>(reach) * step;
    return share > kLeast && share < kMost &&
           fall.residual < kMaxResidual * 0.5 * kGravity * time * time;
  }

  std::size_t stride, reach, length;
  double step;  // Seconds between samples.
};

}  // namespace

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

Vector3d EndTracks::velocity_of(int end, std::size_t i) const {
  const std::size_t half = velocity_reach(frame_time);
  const std::size_t from = i < half ? 0 : i - half, to = std::min(i + half, count - 1);
  if (to == from) return Vector3d::Zero();
  return (places[end][to] - places[end][from]) / (frame_time * static_cast<double>(to - from));
}

std::vector<char> frames_in_free_fall(const SourceFeet& feet, const EndTracks& tracks) {
  std::vector<char> falls(tracks.count, 0);
  const FallSections sections(tracks.frame_time);
  if (sections.reach == 0 || feet.hips.size() != tracks.count) return falls;
  std::vector<double> lowest = tracks.lowest;
  for (double& height : lowest) height *= tracks.scale;
  const std::size_t overlap = velocity_reach(tracks.frame_time);
  for (std::size_t first = 0; first + sections.length <= tracks.count; ++first) {
    if (!sections.falls(feet.hips, first) || !sections.falls(lowest, first)) continue;
    const std::size_t begin = first < overlap ? 0 : first - overlap;
    const std::size_t end = std::min(first + sections.length + overlap, tracks.count);
    for (std::size_t i = begin; i < end; ++i) falls[i] = 1;
  }
  return falls;
}

bool has_whole_feet(const SourceFeet& feet) {
  return feet.foot_count == 2 && feet.has_ankle[0] && feet.has_ankle[1] && feet.has_toe[0] &&
         feet.has_toe[1] && feet.frame_count() >= 3;
}

}  // namespace retarget
