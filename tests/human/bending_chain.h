#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/so3.h"

namespace retarget::track_test {

using Eigen::Vector3d;

inline constexpr int kJoints = 4, kFrames = 60;

// A chain that swings, never near its zero pose, on a root that moves along x.
inline Clip bending_chain() {
  std::vector<Joint> joints(kJoints);
  for (int i = 0; i < kJoints; ++i) {
    joints[static_cast<std::size_t>(i)] = {
        "joint" + std::to_string(i), i - 1, Vector3d::UnitY(), {}, {}};
  }
  joints[0].channels = {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition};
  Clip clip(std::make_shared<const Skeleton>(joints), FrameRate{30, 1}, kFrames);
  for (int frame = 0; frame < kFrames; ++frame) {
    clip.translations(frame)[0] = Vector3d(0.02 * frame, 1.0, 0.0);
    for (int joint = 0; joint < kJoints; ++joint) {
      const double angle = 1.0 + 0.3 * std::sin(0.15 * frame + joint);
      clip.rotations(frame)[static_cast<std::size_t>(joint)] = exp_so3(Vector3d(angle, 0.0, 0.0));
    }
  }
  return clip;
}

inline bool same_clips(const Clip& a, const Clip& b) {
  for (int frame = 0; frame < kFrames; ++frame) {
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      if (a.rotations(frame)[joint].coeffs() != b.rotations(frame)[joint].coeffs()) return false;
    }
    if (a.translations(frame)[0] != b.translations(frame)[0]) return false;
  }
  return true;
}

inline constexpr FrameRange kWhole{0, kFrames};

}  // namespace retarget::track_test
