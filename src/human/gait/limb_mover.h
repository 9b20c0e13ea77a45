#pragma once

#include <Eigen/Geometry>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/two_bone_leg.h"

namespace retarget {

/// Moves an ankle or a wrist of a clip by turning the joints of its limb. The rest of the body stays.
class LimbMover {
 public:
  /// Learns from the whole clip how the knee or elbow bends.
  /// @param joints  a leg, or shoulder, elbow and wrist
  /// @param middle  the shin or the forearm
  LimbMover(const Clip& clip, const Calibration& calibration, const LegJoints& joints, Bone middle);

  /// @param turn   world rotation of the foot or hand
  /// @param shift  displacement of the ankle relative to the hip (wrist, shoulder); world, metres
  void move_end(Clip& clip, int frame, const Eigen::Quaterniond& turn,
                const Eigen::Vector3d& shift) const;

 private:
  Eigen::Quaterniond human_from_source_;
  double metres_per_unit_;
  TwoBoneLeg leg_;
};

}  // namespace retarget
