#pragma once

#include <Eigen/Geometry>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/two_bone_leg.h"

namespace retarget {

/// Moves an ankle of a clip by turning the joints of its leg. The rest of the body stays.
class LegMover {
 public:
  /// Learns from the whole clip how the knee bends.
  LegMover(const Clip& clip, const Calibration& calibration, const LegJoints& joints, Side side);

  /// @param turn   world rotation of the foot
  /// @param shift  displacement of the ankle relative to the hip; world, metres
  void move_ankle(Clip& clip, int frame, const Eigen::Quaterniond& turn,
                  const Eigen::Vector3d& shift) const;

 private:
  Eigen::Quaterniond human_from_source_;
  double metres_per_unit_;
  TwoBoneLeg leg_;
};

}  // namespace retarget
