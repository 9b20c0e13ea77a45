#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace retarget {

/// An end of a robot's limb; LimbDirections uses the middle of two ends, or one end twice.
struct LimbEnd {
  int body = 0;  ///< Index into Robot::bodies().
  Eigen::Vector3d body_from_joint = Eigen::Vector3d::Zero();
};

/// World directions of a limb of the human and of the robot by frame, of any length. The human is
/// rotated by the constant yaw that aligns both.
struct LimbDirections {
  static constexpr int kRanks = 3;

  std::array<LimbEnd, 2> from, to;
  int rank = 0;  ///< 0: trunk and lines across it; 1: thighs and upper arms; 2: farther limbs.
  bool of_legs = false;  ///< Part of the legs, or the line between the hips.
  std::vector<Eigen::Vector3d> human, robot;
  /// By frame: whether the human's limb is high enough that the floor does not constrain it. Empty:
  /// always.
  std::vector<char> free;

  [[nodiscard]] bool is_free(std::size_t frame) const { return free.empty() || free[frame] != 0; }
};

}  // namespace retarget
