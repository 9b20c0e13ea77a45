#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// A target skeleton with its recognised bones and its calibration.
struct TransferTarget {
  std::shared_ptr<const Skeleton> skeleton;
  BoneMap map;
  Calibration calibration;
};

/// Transfers the motion to the target skeleton, without planting feet.
[[nodiscard]] Clip transfer(const Clip& clip, const Calibration& calibration,
                            const TransferTarget& target);

/// Joints that a transfer does not carry over.
struct UncarriedJoints {
  std::vector<std::string> left_out;  ///< Moving joints of the source without a match.
  std::vector<std::string> at_rest;   ///< Joints of the target that stay at rest.
};
[[nodiscard]] UncarriedJoints uncarried_joints(const Clip& clip, const Calibration& calibration,
                                               const TransferTarget& target);

/// Plants the feet of a transferred clip, because bodies of other proportions slide where the
/// source stands. Each foot that stands on its toes, sole or heel moves over the floor no more than
/// the source's, in proportion, and has the same height above it.
/// @param moved  result of transfer(clip, calibration, target); modified.
/// @return kInput errors as for BodyMover::of.
[[nodiscard]] Result<PlantSummary> plant_transferred_feet(Clip& moved, const TransferTarget& target,
                                                          const Clip& clip,
                                                          const Calibration& calibration);

/// Joints of two skeletons matched by their own and their parent's name, with the difference of
/// their rest poses.
struct SharedJoints {
  std::vector<int> twins;  ///< Index in the source of each target joint; -1: none.
  /// One per target joint: rotation from source rest axes to target rest axes. Bones use both
  /// T-poses; other matched joints use their parent's rotation, adjusted so that their child
  /// directions are kept.
  std::vector<Eigen::Quaterniond> turns;
  Eigen::Quaterniond world_turn;  ///< Rotation from the source's to the target's world axes.

  /// Returns the rotation of a joint's parent, or of the world.
  [[nodiscard]] const Eigen::Quaterniond& turn_above(const Skeleton& target, int joint) const {
    const int parent = target.joint(joint).parent;
    return parent < 0 ? world_turn : turns[parent];
  }
};

}  // namespace retarget
