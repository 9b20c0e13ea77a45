#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// The rotations and translations of a clip on other joints.
inline Clip with_joints(const Clip& clip, std::vector<Joint> joints) {
  Clip twin(std::make_shared<const Skeleton>(std::move(joints)), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    std::ranges::copy(clip.rotations(frame), twin.rotations(frame).begin());
    std::ranges::copy(clip.translations(frame), twin.translations(frame).begin());
  }
  return twin;
}

}  // namespace retarget
