#pragma once

#include <memory>

#include "retarget/human/bone_map.h"
#include "retarget/human/human_clip.h"
#include "retarget/motion/clip.h"

namespace retarget {

/// A skeleton that is to be moved: its bones and axes, as recognition and calibration found them.
struct TransferTarget {
  std::shared_ptr<const Skeleton> skeleton;
  BoneMap map;
  HumanMapping mapping;
};

/// A human's movement on another skeleton, through the T-pose: with world rotations of source and
/// target in their T-poses S_T and G_T, each mapped joint turns by R_target = R_source S_T^-1 G_T.
/// Both sides know their T-pose as the canonical human's, so this is the canonical bone's rotation
/// times the inverse of the target's joint_from_bone.
///
/// The hips' path is scaled by the bodies' sizes (HumanMapping::size: leg lengths), raised by what
/// the soles are farther below the hips than the source's, so that who stood on the floor stands on
/// it, and put on the hips, or on the root above them where they have no position channels. Joints
/// that are no bone keep their rest rotation (zero). Joint order, offsets and channels are the
/// target's.
[[nodiscard]] Clip transfer(const Clip& clip, const HumanMapping& mapping,
                            const TransferTarget& target);

}  // namespace retarget
