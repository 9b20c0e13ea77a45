#pragma once

#include <string>
#include <vector>

#include "human/human_clip.h"
#include "retarget/motion.h"
#include "rig/limbs.h"

namespace retarget {

/// How far a robot's limb segment points from the human's, over a motion.
struct LimbError {
  std::string segment;  ///< `left thigh`, `right forearm`, `trunk`, ...
  double mean = 0.0;    ///< Mean angle over the frames, rad.
};

/// Angles between the segments of human and robot in the same frames: thighs, shins, upper arms,
/// forearms, trunk, hip and shoulder line; from joint positions alone, so that no offset or weight
/// of a mapping plays a part.
[[nodiscard]] std::vector<LimbError> limb_errors(const HumanClip& human, const RobotClip& robot,
                                                 const RobotAnatomy& limbs);

/// Mean over the segments, rad.
[[nodiscard]] double mean_limb_error(const std::vector<LimbError>& errors);

}  // namespace retarget
