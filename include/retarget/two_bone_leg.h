#pragma once

#include <Eigen/Geometry>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/pose.h"

namespace RETARGET_API retarget {

/// Joints of a leg, each a descendant of the previous one.
struct LegJoints {
  int hip = -1, knee = -1, ankle = -1;
};

/// The bend axis of the knee in the knee joint's frame, unit length: the mean over all frames with
/// a clearly bent knee. `fallback` without such frames or if their axes disagree.
[[nodiscard]] Eigen::Vector3d learned_hinge(const Clip& clip, const LegJoints& joints,
                                            const Eigen::Vector3d& fallback);

/// Soft limit of a leg's extension. Up to `begin`, the leg reaches the target distance from hip to
/// ankle. Beyond it, the extension grows progressively less, by at most `room`. Near full
/// extension, small changes of the distance cause large changes of the knee angle, so that a leg
/// without this limit would snap.
struct LegReach {
  double begin = 0.0, room = 0.0;

  /// @param length  total length of thigh and shin.
  /// @param own     distance from hip to ankle before the foot is moved; a leg that is straight in
  ///   the original motion stays straight.
  /// @param moved   displacement of the ankle relative to the hip; the larger it is, the less `own`
  ///   is used. All in the same unit.
  /// @param soft, farthest  shares of the length: the extension is free up to `soft` and saturates
  ///   at `farthest`.
  static LegReach of(double length, double own, double moved, double soft, double farthest);

  /// The limited distance for a target distance.
  [[nodiscard]] double at(double wanted) const;
  /// The limit with half the room. The leg reaches distances within it with a negligible error.
  [[nodiscard]] LegReach halved() const { return {begin, 0.5 * room}; }
  /// The distance up to which the error is negligible.
  [[nodiscard]] double easily() const { return begin + 0.5 * room; }
};

/// Two-bone inverse kinematics of one leg, in the file's units and axes.
class TwoBoneLeg {
 public:
  /// @param hinge  bend axis of the knee in the knee joint's frame.
  TwoBoneLeg(const LegJoints& joints, const Eigen::Vector3d& hinge)
      : joints_(joints), hinge_(hinge) {}

  [[nodiscard]] const LegJoints& joints() const { return joints_; }

  /// Rotates hip, knee and ankle so that the ankle joint reaches the target pose, as far as the
  /// limit of the extension allows. The knee bends in its current plane, or about its hinge if it
  /// is nearly straight, and never further backwards than before.
  /// @return the remaining distance.
  double reach(Clip& clip, int frame, const Pose& world_from_ankle, const LegReach& stretch) const;

 private:
  LegJoints joints_;
  Eigen::Vector3d hinge_;
};

}  // namespace retarget
