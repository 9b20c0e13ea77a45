#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "retarget/human.h"

namespace retarget {

/// A point that defines an end of a robot's limb.
struct LimbEnd {
  int body = 0;  ///< Index into Robot::bodies().
  /// Position in the body frame, metres.
  Eigen::Vector3d body_from_joint = Eigen::Vector3d::Zero();
};

/// Directions of a limb of the human and of the robot by frame; world axes, not normalised. A
/// constant yaw rotates the human's directions to the robot's.
struct LimbDirections {
  static constexpr int kRanks = 3;

  /// The limb extends from the middle of the points `from` to the middle of the points `to`.
  std::array<LimbEnd, 2> from, to;
  int rank = 0;  ///< 0: trunk and lines across it; 1: thighs and upper arms; 2: outer limbs.
  bool of_legs = false;     ///< Whether it belongs to the legs or is the line between the hips.
  Side side = Side::kNone;  ///< kNone: trunk and lines across it.
  std::vector<Eigen::Vector3d> human, robot;
  /// One entry per frame: whether the human's limb is so high that the floor does not constrain it.
  /// Empty: true in all frames.
  std::vector<char> free;

  [[nodiscard]] bool is_free(std::size_t frame) const { return free.empty() || free[frame] != 0; }
};

}  // namespace retarget
