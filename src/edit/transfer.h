#pragma once

#include <memory>
#include <string>
#include <vector>

#include "edit/plant_feet.h"
#include "human/bone_map.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"

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
/// it, and put on the hips, or on the root above them where they have no position channels.
///
/// Joints that are no bone (fingers, a second neck joint, helpers) but have a twin in the source,
/// of the same name below a joint of the same name, turn as it does; so do translations of twins,
/// scaled. The others keep their rest rotation (zero). Joint order, offsets and channels are the
/// target's.
[[nodiscard]] Clip transfer(const Clip& clip, const HumanMapping& mapping,
                            const TransferTarget& target);

/// What a transfer does not carry over.
struct UncarriedJoints {
  std::vector<std::string> left_out;  ///< Joints of the source that turn or move and have no twin.
  std::vector<std::string> at_rest;   ///< Joints of the target that stay as they are.
};
[[nodiscard]] UncarriedJoints uncarried_joints(const Clip& clip, const HumanMapping& mapping,
                                               const TransferTarget& target);

/// Plants the feet of a clip that was transferred: bodies of other proportions slide where the
/// source stands. Each foot that stands on its toes, sole or heel moves over the floor no more than
/// the source's, in proportion, and is as high over it.
/// @param moved  transfer(clip, mapping, target); changed.
/// @param file   for messages.
/// @return kInput errors as BodyMover::of.
[[nodiscard]] Result<PlantSummary> plant_transferred_feet(Clip& moved, const TransferTarget& target,
                                                          const Clip& clip,
                                                          const HumanMapping& mapping,
                                                          const PlantOptions& options,
                                                          const std::string& file);

}  // namespace retarget
