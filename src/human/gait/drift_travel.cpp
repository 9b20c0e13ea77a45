#include "human/gait/drift_travel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "human/gait/track_noise.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Track = std::vector<Vector3d>;

// RMS horizontal change over some frames.
double change_over(std::size_t frames, const Track& drift) {
  double sum = 0.0;
  for (std::size_t i = 0; i + frames < drift.size(); ++i) {
    sum += (drift[i + frames] - drift[i]).head<2>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(drift.size() - frames));
}

}  // namespace

void keep_travel(Track& drift, double wander, double frame_time) {
  // In walks and runs with exact roots, drifts change by up to 1.7 times the wandering of the legs.
  constexpr double kExplained = 1.8;
  constexpr double kSlow = 0.3;  // Hz
  if (drift.size() < 2) return;
  const auto second = static_cast<std::size_t>(std::max(1L, std::lround(1.0 / frame_time)));
  const std::size_t frames = std::min(second, drift.size() - 1);
  // Errors of a random walk grow with the root of the time.
  const double time = static_cast<double>(frames) / static_cast<double>(second);
  if (change_over(frames, drift) > kExplained * wander * std::sqrt(time)) return;
  const Track slow = smoothed(drift, smoothing_strength(kSlow, frame_time));
  for (std::size_t i = 0; i < drift.size(); ++i) drift[i].head<2>() -= slow[i].head<2>();
}

}  // namespace retarget
