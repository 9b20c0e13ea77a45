#pragma once

#include <array>
#include <vector>

#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "edit/seam_blend.h"
#include "motion/contact_phases.h"

namespace retarget {

/// The feet of one of two clips that are joined.
struct ClipFeet {
  std::array<std::vector<Pose>, 2> ankles;  ///< Where the clip lies in the result.
  FootContacts contacts;
};

/// The motion over the ground that brings one place of a foot to another, heading and all.
[[nodiscard]] GroundPose between_places(const Pose& from, const Pose& to);

/// Where the feet stand in the joined clip: as in the clip they come from, but that a foot which
/// stands in both around the seam stays where a has it until it leaves the floor in b. A foot that
/// stands in one alone stands as long as the blend leaves it near the floor, and as that clip counts
/// more than the other.
/// @param blended  of the joined clip before feet are planted.
[[nodiscard]] std::vector<PlantedFoot> joined_plants(const ClipFeet& a, const ClipFeet& b,
                                                     const ClipFeet& blended,
                                                     const SeamRegion& region,
                                                     const FrameRate& rate);

}  // namespace retarget
