#pragma once

#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/human.h"

namespace retarget {

/// Finds the joints that twist thighs, shins, upper arms and forearms; -1 for bones without one.
///
/// Some rigs divide a limb's segment into several joints that share its twist. The next bone
/// follows the last of them. They are twist joints if they stay near the straight line of the
/// segment in all poses, and the part of the segment beyond them keeps its direction. The first
/// joint of a knee with two joints bends this part.
[[nodiscard]] BoneArray<int> find_twist_joints(const Body& body,
                                               const std::vector<JointPoses>& poses);

/// Makes twist joints, which rotate their bones in `bones`, the twist joints of these sources. The
/// joints at the start of the bones become their rotation joints (BoneSource).
/// @param starts  joints that turn the bones at their start
/// @param rest    a pose without twist between both joints
void split_twists(const BoneArray<int>& twist_joints, const BoneArray<int>& starts,
                  const JointPoses& rest, BoneArray<BoneSource>& bones);

}  // namespace retarget
