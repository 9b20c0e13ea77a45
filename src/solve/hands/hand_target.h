#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "human/skeleton/source_hands.h"
#include "robot/anatomy/robot_hands.h"

namespace retarget {

/// Target of a robot's hand in one frame, from a human's hand. All directions are in the axes of
/// the palm.
struct HandTarget {
  /// Target directions of a finger's parts between its corners: unit vectors, by Finger and part. A
  /// finger without parts (count 0) follows nothing.
  struct Parts {
    static constexpr int kMaxParts = 8;
    int count = 0;
    std::array<Eigen::Vector3d, kMaxParts> directions;
  };
  std::array<Parts, kFingerCount> parts;
  /// By Finger: target distance of its tip to the thumb's, skin to skin, metres; and the weight of
  /// this distance, from 0 (independent fingers) to 1 (touching fingers).
  std::array<double, kFingerCount> gap{};
  std::array<double, kFingerCount> touch{};
  std::array<bool, kFingerCount> has_gap{};
};

/// Thumb and finger count as touching up to this gap, per finger length.
inline constexpr double kTouchingGap = 0.02;

/// The correspondence between robot and source fingers.
class HandMatch {
 public:
  /// @param hand  must outlive this object.
  explicit HandMatch(const RobotHand& hand);

  [[nodiscard]] const RobotHand& hand() const { return *hand_; }
  /// Shares of a finger's length at its corners, from 0 to 1; by index into hand().fingers.
  [[nodiscard]] const std::vector<double>& shares(std::size_t finger) const {
    return shares_[finger];
  }

  /// Computes the target for a hand shape. Does not allocate.
  void target(const HandShape& shape, HandTarget& target) const;

 private:
  const RobotHand* hand_;
  std::vector<std::vector<double>> shares_;
  // For each finger that the robot lacks: index into `fingers` of the one that replaces it; -1 if
  // none.
  std::array<int, kFingerCount> followers_{};
};

/// The shape of a human's relaxed hand: fingers half open.
[[nodiscard]] HandShape relaxed_hand();

}  // namespace retarget
