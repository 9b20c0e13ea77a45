#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/two_bone_leg.h"

namespace retarget {

/// The quintic from 0 to 1 with zero velocity and acceleration at both ends; constant beyond them.
[[nodiscard]] inline double quintic_step(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * s * (10.0 + s * (6.0 * s - 15.0));
}

/// Moves an ankle or a wrist of a clip by turning the joints of its limb. The rest of the body does
/// not move.
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
