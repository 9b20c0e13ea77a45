#include "human/gait/stance_likelihood.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "retarget/statistics.h"

namespace retarget {
namespace {

// Approximately exp(-x^2), bit-identical on every machine.
double falloff(double x) {
  const double y = x * x;
  return 1.0 / (1.0 + y * (1.0 + y * (0.5 + y / 6.0)));
}

// Frames in which the body is in the air: the feet fall freely with it, or the lowest foot is far
// above its level within a second.
std::vector<char> frames_aloft(const EndTracks& tracks, const std::vector<char>& falls) {
  constexpr double kJump = 0.12, kMaxSpread = 0.1;
  const double middle = median(tracks.lowest);
  std::vector<double> off;
  for (const double height : tracks.lowest) off.push_back(std::abs(height - middle));
  const double high = kJump + 2.0 * std::min(1.48 * median(off), kMaxSpread);
  const auto reach = static_cast<std::size_t>(std::lround(1.0 / tracks.frame_time));
  std::vector<char> aloft(tracks.count, 0);
  for (std::size_t i = 0; i < tracks.count; ++i) {
    const std::size_t from = i < reach ? 0 : i - reach;
    const std::size_t to = std::min(i + reach + 1, tracks.count);
    const double floor = percentile({tracks.lowest.begin() + static_cast<std::ptrdiff_t>(from),
                                     tracks.lowest.begin() + static_cast<std::ptrdiff_t>(to)},
                                    10.0);
    aloft[i] = falls[i] != 0 || tracks.lowest[i] - floor > high ? 1 : 0;
  }
  return aloft;
}

}  // namespace

std::array<std::vector<double>, kEndCount> stance_likelihood(const EndTracks& tracks,
                                                             const std::vector<char>& falls,
                                                             const PlantedParts& parts,
                                                             double turning) {
  constexpr double kFree = 0.02, kWidth = 0.03, kEndFree = 0.005, kEndWidth = 0.015;
  // Only the lower end of a turning foot may stand, with a lower likelihood.
  constexpr double kTurningShare = 0.1;
  const std::vector<char> aloft = frames_aloft(tracks, falls);
  // A body that climbs stands on the upper foot, and carries the lower one.
  const auto stands_while_body_climbs = [&](int foot, std::size_t i) {
    return parts.is_planted(foot, i) && (aloft[i] != 0 || parts.is_carried(1 - foot, i));
  };
  std::array<std::vector<double>, kEndCount> stands;
  for (int end = 0; end < kEndCount; ++end) {
    stands[end].assign(tracks.count, 0.0);
    for (std::size_t i = 0; i < tracks.count; ++i) {
      const int foot = end / 2;
      const bool climbs = stands_while_body_climbs(foot, i);
      if (falls[i] != 0 || (aloft[i] != 0 && !climbs) || parts.is_carried(foot, i)) continue;
      const double lower = tracks.lower(foot, i);
      const double over = climbs ? 0.0 : lower - tracks.lowest[i];
      const double near = falloff(std::max(0.0, over - kFree) / kWidth);
      const double steady = falloff(tracks.turning(foot, i) / turning);
      const double rise = std::max(0.0, tracks.heights[end][i] - lower - kEndFree);
      stands[end][i] = near * (steady + (1.0 - steady) * kTurningShare * falloff(rise / kEndWidth));
    }
  }
  return stands;
}

}  // namespace retarget
