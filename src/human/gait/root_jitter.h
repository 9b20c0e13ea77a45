#pragma once

#include <optional>

#include "retarget/human.h"
#include "retarget/motion.h"

namespace retarget {

/// Noise of the position of the body that was smoothed.
struct RootJitter {
  double step = 0.0;    ///< RMS change of the error per frame, metres.
  double cutoff = 0.0;  ///< Of the low-pass filter, Hz.
};

/// Smooths the path of the hips if its errors are independent. They shake both feet, so that none
/// seems to stand. A drift, which is slower, remains, and so do jumps.
/// @param white  whether the joints had independent errors, too; weaker evidence then suffices.
/// @return nothing if the clip is unchanged
std::optional<RootJitter> smooth_root_jitter(Clip& clip, FrameRange part,
                                             const Calibration& calibration, bool white);

}  // namespace retarget
