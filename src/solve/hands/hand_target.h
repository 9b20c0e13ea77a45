#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "human/skeleton/source_hands.h"
#include "robot/anatomy/robot_hands.h"

namespace retarget {

/// Target of a robot's hand in one frame, made from a human's hand. Directions are in palm axes.
struct HandTarget {
  /// Target directions of the parts of a finger between its corners, as unit vectors. A finger
  /// without parts (count 0) has no target directions.
  struct Parts {
    static constexpr int kMaxParts = 8;
    int count = 0;
    std::array<Eigen::Vector3d, kMaxParts> directions;
  };
  std::array<Parts, kFingerCount> parts;  ///< One per Finger.
  /// One entry per Finger: target gap between the surfaces of its tip and the thumb's, metres; its
  /// weight, from 0 (distant fingers) to 1 (touching fingers); whether the finger has a target gap.
  std::array<double, kFingerCount> gap{};
  std::array<double, kFingerCount> touch{};
  std::array<bool, kFingerCount> has_gap{};
};

/// Largest gap of a touching thumb and finger, per finger length.
inline constexpr double kTouchingGap = 0.02;

/// The correspondence between robot and source fingers.
class HandMatch {
 public:
  /// @param hand  must outlive this object.
  explicit HandMatch(const RobotHand& hand);

  /// Fractions of a finger's length at its corners, ascending from 0 to 1.
  /// @param finger  index into the fingers of the hand.
  [[nodiscard]] const std::vector<double>& shares(std::size_t finger) const {
    return shares_[finger];
  }

  /// Computes the target for a hand shape. Does not allocate.
  void target(const HandShape& shape, HandTarget& target) const;

 private:
  const RobotHand* hand_;
  std::vector<std::vector<double>> shares_;
  // By Finger, for fingers that the robot lacks: index into `fingers` of the replacement; -1: none.
  std::array<int, kFingerCount> followers_{};
};

/// The shape of a human's relaxed hand, with half-open fingers.
[[nodiscard]] HandShape relaxed_hand();

}  // namespace retarget
