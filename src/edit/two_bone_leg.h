#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "retarget/edit/plant_feet.h"
#include "retarget/math/pose.h"
#include "retarget/motion/clip.h"

namespace retarget {

/// Two-bone inverse kinematics of one leg, in the file's units and axes.
class TwoBoneLeg {
 public:
  /// @param shin_back  the axis in the knee joint's frame about which a straight knee bends.
  TwoBoneLeg(const LegJoints& joints, const Eigen::Vector3d& shin_back)
      : joints_(joints), bend_axis_(shin_back) {}

  [[nodiscard]] const LegJoints& joints() const { return joints_; }

  /// Length of thigh and shin, of a pose of all joints.
  [[nodiscard]] double length(const std::vector<Pose>& world_from_joint) const;

  /// Turns hip, knee and ankle so that the ankle joint gets the wanted pose, or as near as
  /// `longest` (from hip to ankle) lets it.
  /// @return the distance that is left.
  double reach(Clip& clip, int frame, const Pose& world_from_ankle, double longest) const;

 private:
  LegJoints joints_;
  Eigen::Vector3d bend_axis_;
};

}  // namespace retarget
