#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "edit/transfer.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Joints of two skeletons matched by their own and their parent's name, with the difference of
/// their rest poses.
struct SharedJoints {
  std::vector<int> twins;  ///< By target joint: index in the source; -1: none.
  /// By target joint: rotation from source rest axes to target rest axes. Bones use both T-poses;
  /// other matched joints use their parent's rotation, adjusted so that their child directions are
  /// kept.
  std::vector<Eigen::Quaterniond> turns;
  Eigen::Quaterniond world_turn;  ///< The same rotation for the world axes.

  /// Returns the rotation of a joint's parent, or of the world.
  [[nodiscard]] const Eigen::Quaterniond& turn_above(const Skeleton& target, int joint) const {
    const int parent = target.joint(joint).parent;
    return parent < 0 ? world_turn : turns[parent];
  }
};

/// Returns the canonical bone that each target joint turns, if the source has it.
[[nodiscard]] std::vector<std::optional<Bone>> bones_of_joints(const Calibration& source,
                                                               const TransferTarget& target);

[[nodiscard]] SharedJoints find_shared_joints(const Skeleton& source,
                                              const Calibration& calibration,
                                              const TransferTarget& target);

}  // namespace retarget
