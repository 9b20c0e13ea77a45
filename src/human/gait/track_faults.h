#pragma once

#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Interpolates over frames in which a joint is lost: its rotation is exactly zero for at most a
/// second, the joint is far from zero before and after and jumps in one frame, while other joints
/// continue to move.
/// @return one sentence per joint: `LeftForeArm was lost in 9 frames`.
std::vector<std::string> bridge_lost_joints(Clip& clip, FrameRange part);

/// Limbs that keep their pose through a clip: they were not tracked.
struct StillLimbs {
  bool all = false;                ///< No arm and no leg moves; `names` is then empty.
  std::vector<std::string> names;  ///< Names such as `left leg`.
  bool leg = false;                ///< Whether one of them is a leg.
};

/// Finds clips of several frames in which no limb turns by 0.2 degrees, and single still limbs: the
/// bones of a leg or an arm turn by less than 0.2 degrees relative to the bones that they hang on,
/// while the other one and a leg turn by more than 10. A leg that only stands also keeps its pose,
/// so the foot of a still leg must travel over the ground. Looks at the whole clip, because a limb
/// may be held still in an excerpt.
[[nodiscard]] StillLimbs find_still_limbs(const Clip& clip, const Calibration& calibration);

}  // namespace retarget
