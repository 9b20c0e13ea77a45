#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// Joints of a finger, from the knuckle outwards; the thumb starts at its base at the wrist.
struct SourceFinger {
  Finger finger = Finger::kThumb;
  std::vector<int>
      joints;  ///< Indices in the skeleton. The last one begins the last bone, or is the tip.
  /// End of the finger in the last joint's frame; zero: the last joint is the end.
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
};

/// Fingers of a source's hand: at least two besides the thumb, which define the palm's axes.
struct SourceHand {
  Side side = Side::kLeft;
  int wrist = 0;                      ///< Joint index.
  std::vector<SourceFinger> fingers;  ///< Fingers in the order of Finger, without duplicates.
};

/// Left and right hand; empty for a source without fingers.
using SourceHands = std::array<std::optional<SourceHand>, 2>;

/// Finds the fingers below the hand joints. Joint names identify them (`LeftHandIndex1`,
/// `index_01_l`, `leftIndexProximal`, `Bip01 L Finger1`, MMD's signs, ...). Without such names, the
/// chain that begins nearest to the wrist and points another way is the thumb; the other fingers
/// follow in order of distance from it. Metacarpals are excluded. Missing bone ends are
/// extrapolated: a last bone has nine tenths of the length of the previous one.
[[nodiscard]] SourceHands find_source_hands(const Skeleton& skeleton, const BoneMap& map);

/// A finger in palm axes, as a polyline from the knuckle to the tip.
struct FingerLine {
  static constexpr int kMaxPoints = 6;
  int point_count = 0;  ///< 0: the hand lacks this finger.
  /// Axes: along the hand, across to the thumb's side, out of the palm; the same for both hands.
  std::array<Eigen::Vector3d, kMaxPoints> points;
  double length = 0.0;  ///< Length of the polyline.

  [[nodiscard]] bool is_there() const { return point_count > 1; }
  [[nodiscard]] const Eigen::Vector3d& tip() const { return points[point_count - 1]; }
  /// Returns the point at a share of the length.
  [[nodiscard]] Eigen::Vector3d at(double share) const;
};

/// A hand's fingers in one frame, all in the same arbitrary length unit.
struct HandShape {
  std::array<FingerLine, kFingerCount> fingers;

  [[nodiscard]] FingerLine& line(Finger finger) {
    return fingers[static_cast<std::size_t>(finger)];
  }
  [[nodiscard]] const FingerLine& line(Finger finger) const {
    return fingers[static_cast<std::size_t>(finger)];
  }
};

/// Computes a clip's hand shapes, one frame at a time. The palm axes follow from the positions of
/// wrist and knuckles in the frame and not from the wrist's rotation, so joint positions suffice.
/// Keeps references to its arguments; does not allocate per frame.
class HandPoser {
 public:
  HandPoser(const Clip& clip, const SourceHand& hand);

  /// @return false if the knuckles coincide or are collinear with the wrist; `shape` is then
  ///   unchanged
  bool shape(int frame, HandShape& shape);

 private:
  const Clip& clip_;
  const SourceHand& hand_;
  std::vector<int> joints_;  // Joints of the hand without the wrist, parents first.
  std::vector<int> place_;   // Index in joints_ by skeleton joint; -1: not in joints_.
  std::vector<Pose> wrist_from_joint_;
};

/// Whether a hand's fingers move relative to the palm in frames [begin, end): a fingertip moves by
/// more than 2 % of its finger's length. This is false for zero rotations and for hands that were
/// not recorded.
[[nodiscard]] bool fingers_move(const Clip& clip, const SourceHand& hand, const FrameRange& part);

/// Whether the first two joints of a finger other than the thumb bend by more than 110 degrees in
/// total, as in a fist or a pointing hand. In default poses of files without recorded fingers
/// (straight, SMPL's mean hand, the curl of a skeleton), they bend less.
[[nodiscard]] bool fingers_are_closed(const Clip& clip, const SourceHand& hand, int frame);

/// Whether the hand differs from the skeleton's rest pose (zero rotations): a fingertip by more than
/// 2 % of its finger's length.
[[nodiscard]] bool fingers_leave_rest(const Clip& clip, const SourceHand& hand, int frame);

}  // namespace retarget
