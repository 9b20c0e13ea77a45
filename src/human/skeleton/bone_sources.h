#pragma once

#include "human/skeleton/human_clip.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/rest_pose.h"
#include "retarget/human.h"

namespace retarget {

/// Returns the sources of all canonical bones. Unmapped bones are attached rigidly to their
/// neighbours:
///
/// * Spine, Spine1, Spine2: the next mapped joint up the trunk; for Spine2 the next one down;
/// * Neck and Head: each other, with the head at the neck's end; a head whose position is unknown
///   is left out;
/// * collar bones: turn with the torso, at the upper arm's joint;
/// * hands: turn with the forearm, at its end site, or 0.8 upper arm lengths along it;
/// * toes, also those with implausible rotations: turn with the foot, at their joint, at the foot's
///   end site, or 0.2 leg lengths along it (LAFAN1's proportion);
/// * the synthetic feet: at the ankle, turn with the toes.
///
/// @param axes  axes of the mapped bones
/// @param rest  a pose that gives the bone lengths
[[nodiscard]] BoneArray<BoneSource> bone_sources(const Body& body, const JointFromBone& axes,
                                                 const JointPoses& rest);

}  // namespace retarget
