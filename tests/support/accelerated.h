#pragma once

#include "retarget/clip.h"
#include "support/clip_sampler.h"

namespace retarget {

/// The frames of a clip at a speed that grows evenly, from half of the clip's own speed at the start
/// to 1.5 times at the end.
[[nodiscard]] inline Clip accelerated(const Clip& clip) {
  const ClipSampler sampler(clip);
  Clip result = clip;
  constexpr double kFirst = 0.5;
  const double duration = clip.duration();
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double share = frame / (clip.frame_count() - 1.0);
    sampler.sample(duration * share * (kFirst + (1.0 - kFirst) * share), result.rotations(frame),
                   result.translations(frame));
  }
  return result;
}

}  // namespace retarget
