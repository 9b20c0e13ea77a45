#pragma once

#include <vector>

#include "edit/concatenate.h"
#include "edit/plant_feet.h"
#include "edit/seam_blend.h"
#include "edit/seam_feet.h"
#include "human/human_clip.h"

namespace retarget {

/// Speeds and accelerations of the joints at a seam, against what the same joints do in both clips.
[[nodiscard]] SeamCheck check_motion(const HumanClip& a, const HumanClip& b,
                                     const HumanClip& joined, const SeamRegion& region,
                                     const MotionLimits& limits);

/// Fills in what planted feet do at a seam: slip and jump.
void check_feet(SeamCheck& check, const ClipFeet& a, const ClipFeet& b, const ClipFeet& joined,
                const std::vector<PlantedFoot>& plants, const SeamRegion& region,
                const FrameRate& rate);

/// Says what is wrong, in check.faults.
void find_faults(SeamCheck& check, const Seam& seam, const ConcatenateOptions& options);

}  // namespace retarget
