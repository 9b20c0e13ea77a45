#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "anatomy/robot_hands.h"
#include "human/source_hands.h"

namespace retarget {

/// What a human's hand asks of a robot's in one frame. All in the axes of the palm.
struct HandTarget {
  /// Of a finger's parts between corners, where they should point: unit vectors, by Finger and part; a
  /// finger without any (part_count 0) follows nothing.
  struct Parts {
    static constexpr int kMaxParts = 8;
    int count = 0;
    std::array<Eigen::Vector3d, kMaxParts> directions;
  };
  std::array<Parts, kFingerCount> parts;
  /// How far the tip of a finger should be from the thumb's, skin to skin, metres; by Finger. And how much
  /// that counts, from 0 (fingers that have nothing to do with each other) to 1 (they touch).
  std::array<double, kFingerCount> gap{};
  std::array<double, kFingerCount> touch{};
  std::array<bool, kFingerCount> has_gap{};
};

/// Of a source's fingers, how far the tip of one is from the thumb's by its own length, less what bones
/// are apart when skins touch.
[[nodiscard]] double human_gap(const HandShape& shape, Finger finger);

/// Whether thumb and finger touch: their tips are this near, by the finger's length.
inline constexpr double kTouchingGap = 0.02;

/// How robot and source fingers belong together.
class HandMatch {
 public:
  /// @param hand  outlives the match.
  explicit HandMatch(const RobotHand& hand);

  [[nodiscard]] const RobotHand& hand() const { return *hand_; }
  /// Shares of a finger's length at which its corners are, from 0 to 1; by index into hand().fingers.
  [[nodiscard]] const std::vector<double>& shares(std::size_t finger) const {
    return shares_[finger];
  }

  /// Nothing is allocated.
  void target(const HandShape& shape, HandTarget& target) const;

 private:
  const RobotHand* hand_;
  std::vector<std::vector<double>> shares_;
  std::array<int, kFingerCount> followers_{};  // index into fingers, of each that the robot lacks
};

/// The shape of a human's hand that does nothing: fingers half open.
[[nodiscard]] HandShape relaxed_hand();

}  // namespace retarget
