#pragma once

#include <string>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/human/human_clip.h"
#include "retarget/motion/clip.h"

namespace retarget {

/// For every joint its counterpart on the other side; joints of the middle are their own.
///
/// Joints that are bones are paired by the mapping, those between them by their place along the
/// way, all others (fingers, ends) below paired joints by shape: subtrees of as many joints whose
/// places in the T-pose mirror each other best. Names play no part.
///
/// @param file  for messages.
/// @return a kInput error naming a joint without a counterpart.
[[nodiscard]] Result<std::vector<int>> mirrored_joints(const Skeleton& skeleton,
                                                       const HumanMapping& mapping,
                                                       const std::string& file);

/// The movement of the mirror image, on the same skeleton: left does what right did. The mirror
/// stands upright along the heading of the first frame, at its hips, so that the clip begins where
/// it began; mirroring twice changes nothing.
///
/// With D the world rotation of a joint from the T-pose and M the mirror, its counterpart turns by
/// M D M from its own T-pose. Joints that are no bones have zero rotation in the T-pose.
///
/// @param file  for messages.
/// @return kInput errors as mirrored_joints.
[[nodiscard]] Result<Clip> mirror(const Clip& clip, const HumanMapping& mapping,
                                  const std::string& file);

}  // namespace retarget
