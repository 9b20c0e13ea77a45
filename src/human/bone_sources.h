#pragma once

#include "human/human_clip.h"
#include "human/posed_body.h"
#include "human/rest_pose.h"
#include "retarget/human.h"

namespace retarget {

/// Sources of all canonical bones: those that are mapped, and those that are not from their
/// neighbours, stiffly:
///
/// * Spine, Spine1, Spine2: the next mapped joint up the trunk, of Spine2 the next down;
/// * Neck and Head: each other, a head at the neck's end; else the torso turns a head that has
///   no place, which is left out;
/// * collar bones: turned with the torso, at the upper arm's joint;
/// * hands: turned with the forearm, at its end site, or 0.8 upper arms along it;
/// * toes, also those whose rotations are not believed: turned with the foot, at their joint, at the
///   foot's end site, or 0.2 legs along it (LAFAN1's proportion);
/// * the synthetic feet: at the ankle, turned like the toes.
///
/// @param axes  of the mapped bones.
/// @param rest  a pose, for lengths of bones.
[[nodiscard]] BoneArray<BoneSource> bone_sources(const Body& body, const JointFromBone& axes,
                                                 const JointPoses& rest);

}  // namespace retarget
