#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "retarget/options.h"
#include "retarget/so3.h"
#include "retarget/spline.h"

namespace retarget {

/// Makes a track sign-continuous: replaces q by -q where that is nearer to the previous rotation.
inline void make_sign_continuous(std::vector<Eigen::Quaterniond>& track) {
  for (std::size_t i = 1; i < track.size(); ++i) {
    align_sign(track[i - 1].coeffs(), track[i].coeffs());
  }
}

inline void make_sign_continuous(std::vector<Eigen::Vector3d>&) {}

/// The rotations (Eigen::Quaterniond) or translations (Eigen::Vector3d) of one joint as a function
/// of time. Quaternions are sign-continuous. For cubic interpolation, it stores a velocity per
/// frame, so that each sample takes constant time.
template <typename Value>
class TrackSampler {
 public:
  TrackSampler(std::vector<Value> track, Interpolation interpolation) : track_(std::move(track)) {
    make_sign_continuous(track_);
    if (interpolation == Interpolation::kCubic && !track_.empty()) {
      velocities_ = spline_velocities(steps_between(track_));
    }
  }

  /// Value at `fraction` in [0, 1) between `frame` and the next frame. A fraction of zero, or any
  /// fraction at the last frame, gives the frame itself bit for bit.
  /// @pre frame is one of the track's.
  [[nodiscard]] Value sample(int frame, double fraction) const {
    const auto at = static_cast<std::size_t>(frame);
    if (fraction == 0.0 || at + 1 == track_.size()) return track_[at];
    if (velocities_.empty()) {
      return interpolate_linear(track_[at], track_[at + 1], fraction);
    }
    return interpolate_cubic(track_[at], velocities_[at], track_[at + 1], velocities_[at + 1],
                             fraction);
  }

 private:
  std::vector<Value> track_;
  std::vector<Eigen::Vector3d> velocities_;  // Change per frame; empty for linear interpolation.
};

}  // namespace retarget
