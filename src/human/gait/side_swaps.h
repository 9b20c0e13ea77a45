#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace retarget {

/// Exchanges of left and right in tracks of joint positions.
struct SideSwaps {
  std::vector<std::string> undone;  ///< Sentences: `the legs exchanged sides in 7 frames`.
  std::vector<std::string> kept;    ///< Sentences for exchanges whose frames are not known.

  [[nodiscard]] bool empty() const { return undone.empty() && kept.empty(); }
};

/// Finds frames in which both legs, or both arms, exchange sides: each joint continues the track of
/// the other side. If they exchange back, the frames between are exchanged, provided that these are
/// less than a third of all. Other pairs, such as collarbones, are exchanged with them if they exchange
/// sides at both ends as well. Does not change tracks of files without sides in their names.
/// @param tracks  positions by joint and frame, in any unit
/// @param least   least mean distance by which the joints of a limb jump, in this unit
[[nodiscard]] SideSwaps undo_side_swaps(std::vector<std::vector<Eigen::Vector3d>>& tracks,
                                        const std::vector<std::string>& names, double least);

}  // namespace retarget
