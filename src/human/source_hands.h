#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// The joints of a finger, from the knuckle (of the thumb: from its base at the wrist) outwards.
struct SourceFinger {
  Finger finger = Finger::kThumb;
  std::vector<int>
      joints;  ///< Of the skeleton; the last one is where the last bone begins, or its tip.
  /// Where the finger ends, in the last joint's frame; zero: in the last joint.
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
};

/// The fingers of a source's hand: two at least beside the thumb, else a palm has no direction.
struct SourceHand {
  Side side = Side::kLeft;
  int wrist = 0;                      ///< Joint.
  std::vector<SourceFinger> fingers;  ///< In the order of Finger, each once.
};

/// Left and right; empty where a source has no fingers.
using SourceHands = std::array<std::optional<SourceHand>, 2>;

/// Finds the fingers below the joints that stand for the hands. Names tell which finger a chain is
/// (`LeftHandIndex1`, `index_01_l`, `leftIndexProximal`, `Bip01 L Finger1`, MMD's signs, ...); where they
/// do not, the chain that begins nearest to the wrist and points another way is the thumb, and the
/// others follow from its side on. Metacarpals are left out, ends of bones that nobody told are
/// extrapolated: a last bone is nine tenths of the one before.
[[nodiscard]] SourceHands find_source_hands(const Skeleton& skeleton, const BoneMap& map);

/// A finger in the axes of its palm: the line from the knuckle to the tip.
struct FingerLine {
  static constexpr int kMaxPoints = 6;
  int point_count = 0;  ///< 0: the hand does not have the finger.
  /// Along the hand, across to the thumb's side, and out of the palm: the same for both hands.
  std::array<Eigen::Vector3d, kMaxPoints> points;
  double length = 0.0;  ///< Of the line.

  [[nodiscard]] bool is_there() const { return point_count > 1; }
  [[nodiscard]] const Eigen::Vector3d& tip() const { return points[point_count - 1]; }
  /// Where the line is at a share of its length.
  [[nodiscard]] Eigen::Vector3d at(double share) const;
};

/// A hand's fingers in one frame. Lengths in any unit, the same for all.
struct HandShape {
  std::array<FingerLine, kFingerCount> fingers;

  [[nodiscard]] FingerLine& line(Finger finger) {
    return fingers[static_cast<std::size_t>(finger)];
  }
  [[nodiscard]] const FingerLine& line(Finger finger) const {
    return fingers[static_cast<std::size_t>(finger)];
  }
};

/// Shapes of a clip's hand, a frame at a time. The palm's axes follow from wrist and knuckles in the
/// frame, not from how the wrist's joint turns, so that places of joints alone serve as well.
/// Refers to its clip; nothing is allocated per frame.
class HandPoser {
 public:
  HandPoser(const Clip& clip, const SourceHand& hand);

  /// @return false where the knuckles lie in one place or line with the wrist; the shape is then as it was.
  bool shape(int frame, HandShape& shape);

 private:
  const Clip& clip_;
  const SourceHand& hand_;
  std::vector<int> joints_;  // of the hand, parents first, the wrist left out
  std::vector<int> place_;   // in joints_, of each joint of the skeleton; -1: none
  std::vector<Pose> wrist_from_joint_;
};

/// Whether a hand's fingers move against the palm in frames [begin, end): a fingertip by more than a
/// fiftieth of its finger. Zeros in a file and hands that were not recorded do not.
[[nodiscard]] bool fingers_move(const Clip& clip, const SourceHand& hand, const FrameRange& part);

}  // namespace retarget
