#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "retarget/clip.h"

namespace retarget {

/// Evaluates a cubic Hermite curve over `frames` frames at frame `at`: from `begin` with velocity
/// `begin_velocity` to `end` with `end_velocity` (per frame).
[[nodiscard]] inline Eigen::Vector3d ease(const Eigen::Vector3d& begin,
                                          const Eigen::Vector3d& begin_velocity,
                                          const Eigen::Vector3d& end,
                                          const Eigen::Vector3d& end_velocity, double frames,
                                          double at) {
  const double u = at / frames, left = 1.0 - u;
  return begin * (left * left * (1.0 + 2.0 * u)) + begin_velocity * (frames * u * left * left) +
         end * (u * u * (1.0 + 2.0 * left)) - end_velocity * (frames * left * u * u);
}

/// Evaluates the cubic from `begin` to rest at zero: fades out an offset.
[[nodiscard]] inline Eigen::Vector3d fade(const Eigen::Vector3d& begin,
                                          const Eigen::Vector3d& begin_velocity, double frames,
                                          double at) {
  const Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  return at >= frames ? rest : ease(begin, begin_velocity, rest, rest, frames, at);
}

/// Returns the number of frames in a duration, at least one.
[[nodiscard]] inline int frames_in(double seconds, const FrameRate& rate) {
  constexpr double kMaxSeconds = 1e5;
  return std::max(1, static_cast<int>(std::lround(std::min(seconds, kMaxSeconds) * rate.fps())));
}

}  // namespace retarget
