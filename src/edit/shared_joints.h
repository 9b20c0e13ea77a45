#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "edit/transfer.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// Which joints of two skeletons are one by their own and their parent's name, and how their rest
/// poses differ.
struct SharedJoints {
  std::vector<int> twins;  ///< Of target joints, in the source; -1: none.
  /// Of target joints: from rest axes of the source to those of the target. A bone's are those of
  /// both T-poses; a twin's are its parent's, turned so that what leaves it points as before.
  std::vector<Eigen::Quaterniond> turns;
  Eigen::Quaterniond world_turn;  ///< The same of the worlds.

  /// Of what a joint hangs from.
  [[nodiscard]] const Eigen::Quaterniond& turn_above(const Skeleton& target, int joint) const {
    const int parent = target.joint(joint).parent;
    return parent < 0 ? world_turn : turns[parent];
  }
};

/// The canonical bone that each joint of the target turns and the source has, if any.
[[nodiscard]] std::vector<std::optional<Bone>> bones_of_joints(const Calibration& source,
                                                               const TransferTarget& target);

[[nodiscard]] SharedJoints find_shared_joints(const Skeleton& source,
                                              const Calibration& calibration,
                                              const TransferTarget& target);

}  // namespace retarget
