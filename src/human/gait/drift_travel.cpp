#include "human/gait/drift_travel.h"

#include <cmath>
#include <cstddef>

#include "human/gait/track_noise.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Track = std::vector<Vector3d>;

// RMS horizontal change within a second; 0 for shorter tracks.
double change_in_a_second(const Track& drift, double frame_time) {
  const auto reach = static_cast<std::size_t>(std::lround(1.0 / frame_time));
  if (drift.size() <= reach) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i + reach < drift.size(); ++i) {
    sum += (drift[i + reach] - drift[i]).head<2>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(drift.size() - reach));
}

}  // namespace

void keep_travel(Track& drift, double wander, double frame_time) {
  // In walks and runs with exact roots, drifts change by up to 1.7 times the wandering of the legs.
  constexpr double kExplained = 1.8;
  constexpr double kSlow = 0.3;  // Hz
  if (change_in_a_second(drift, frame_time) > kExplained * wander) return;
  const Track slow = smoothed(drift, smoothing_strength(kSlow, frame_time));
  for (std::size_t i = 0; i < drift.size(); ++i) drift[i].head<2>() -= slow[i].head<2>();
}

}  // namespace retarget
