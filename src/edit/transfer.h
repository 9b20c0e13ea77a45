#pragma once

#include <memory>
#include <string>
#include <vector>

#include "human/bone_map.h"
#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/error.h"
#include "retarget/human.h"

namespace retarget {

/// A skeleton that is to be moved: its bones and axes, as recognition and calibration found them.
struct TransferTarget {
  std::shared_ptr<const Skeleton> skeleton;
  BoneMap map;
  Calibration calibration;
};

/// The movement on the other skeleton, before feet are planted.
[[nodiscard]] Clip transfer(const Clip& clip, const Calibration& calibration,
                            const TransferTarget& target);

/// What a transfer does not carry over.
struct UncarriedJoints {
  std::vector<std::string> left_out;  ///< Joints of the source that turn or move and have no twin.
  std::vector<std::string> at_rest;   ///< Joints of the target that stay as they are.
};
[[nodiscard]] UncarriedJoints uncarried_joints(const Clip& clip, const Calibration& calibration,
                                               const TransferTarget& target);

/// Plants the feet of a clip that was transferred: bodies of other proportions slide where the
/// source stands. Each foot that stands on its toes, sole or heel moves over the floor no more than
/// the source's, in proportion, and is as high over it.
/// @param moved  transfer(clip, calibration, target); changed.
/// @return kInput errors as BodyMover::of.
[[nodiscard]] Result<PlantSummary> plant_transferred_feet(Clip& moved, const TransferTarget& target,
                                                          const Clip& clip,
                                                          const Calibration& calibration,
                                                          const PlantOptions& options);

}  // namespace retarget
