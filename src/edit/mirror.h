#pragma once

#include <string>
#include <vector>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// For every joint its counterpart on the other side; joints of the middle are their own.
///
/// Joints that are bones are paired by the mapping, those between them by their place along the
/// way, all others (fingers, ends) below paired joints by shape: subtrees of as many joints at
/// places that mirror each other best. Names play no part.
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
/// With W the world rotation of a joint, M the mirror and S the reflection between the axes of the
/// joint and of its counterpart, the counterpart's world rotation is M W S^-1. S comes from the
/// skeleton: most zero poses are their own mirror image; only else does the T-pose say more, and
/// where that is guessed, the nearest reflection of axes is meant.
///
/// @param file  for messages.
/// @return kInput errors as mirrored_joints.
[[nodiscard]] Result<Clip> mirror(const Clip& clip, const HumanMapping& mapping,
                                  const std::string& file);

}  // namespace retarget
