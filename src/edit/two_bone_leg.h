#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "retarget/edit/plant_feet.h"
#include "retarget/math/pose.h"
#include "retarget/motion/clip.h"

namespace retarget {

/// The axis in the knee joint's frame about which a knee bends, a unit vector: the mean of that in
/// all frames in which it is clearly bent; where there are none, or they differ, `fallback`.
[[nodiscard]] Eigen::Vector3d learned_hinge(const Clip& clip, const LegJoints& joints,
                                            const Eigen::Vector3d& fallback);

/// Two-bone inverse kinematics of one leg, in the file's units and axes.
class TwoBoneLeg {
 public:
  /// @param hinge  the axis in the knee joint's frame about which the knee bends.
  TwoBoneLeg(const LegJoints& joints, const Eigen::Vector3d& hinge)
      : joints_(joints), hinge_(hinge) {}

  [[nodiscard]] const LegJoints& joints() const { return joints_; }

  /// Length of thigh and shin, of a pose of all joints.
  [[nodiscard]] double length(const std::vector<Pose>& world_from_joint) const;

  /// Turns hip, knee and ankle so that the ankle joint gets the wanted pose, or as near as
  /// `longest` (from hip to ankle) lets it. The knee bends in the plane that it is bent in; the
  /// less it is bent, the more about its hinge; and never backwards farther than it was.
  /// @return the distance that is left.
  double reach(Clip& clip, int frame, const Pose& world_from_ankle, double longest) const;

 private:
  LegJoints joints_;
  Eigen::Vector3d hinge_;
};

}  // namespace retarget
