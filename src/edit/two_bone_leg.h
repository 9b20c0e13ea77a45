#pragma once

#include <Eigen/Geometry>

#include "edit/plant_feet.h"
#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/pose.h"

namespace retarget {

/// The axis in the knee joint's frame about which a knee bends, a unit vector: the mean of that in
/// all frames in which it is clearly bent; where there are none, or they differ, `fallback`.
[[nodiscard]] Eigen::Vector3d learned_hinge(const Clip& clip, const LegJoints& joints,
                                            const Eigen::Vector3d& fallback);

/// How far a leg is stretched. Up to `begin` a wanted distance from hip to ankle is what the leg
/// gives; beyond it stretches less and less, by `room` at most. Near full stretch a small change of
/// the distance is a large one of the knee's angle: a leg that followed to its end would snap.
struct LegReach {
  double begin = 0.0, room = 0.0;

  /// @param length  of thigh and shin.
  /// @param own     from hip to ankle before the foot is moved: a leg that is straight in the motion
  ///                itself stays so,
  /// @param moved   the less the farther the ankle is moved against the hip; same unit.
  static LegReach of(double length, double own, double moved, const PlantOptions& options);

  [[nodiscard]] double at(double wanted) const;
  /// With what is lacking next to nothing wherever it is asked for.
  [[nodiscard]] LegReach halved() const { return {begin, 0.5 * room}; }
  /// Up to here what is lacking is next to nothing.
  [[nodiscard]] double easily() const { return begin + 0.5 * room; }
};

/// Two-bone inverse kinematics of one leg, in the file's units and axes.
class TwoBoneLeg {
 public:
  /// @param hinge  the axis in the knee joint's frame about which the knee bends.
  TwoBoneLeg(const LegJoints& joints, const Eigen::Vector3d& hinge)
      : joints_(joints), hinge_(hinge) {}

  [[nodiscard]] const LegJoints& joints() const { return joints_; }

  /// Turns hip, knee and ankle so that the ankle joint gets the wanted pose, or as near as the
  /// leg's stretch lets it. The knee bends in the plane that it is bent in; the less it is bent,
  /// the more about its hinge; and never backwards farther than it was.
  /// @return the distance that is left.
  double reach(Clip& clip, int frame, const Pose& world_from_ankle, const LegReach& stretch) const;

 private:
  LegJoints joints_;
  Eigen::Vector3d hinge_;
};

}  // namespace retarget
