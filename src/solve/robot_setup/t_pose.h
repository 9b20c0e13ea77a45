#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/human.h"
#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Angles between two sets of bone axes, rad.
struct BoneAxesError {
  double direction = 0.0;  ///< Angle between the X axes.
  double twist = 0.0;      ///< Remaining rotation about X.
};
[[nodiscard]] BoneAxesError bone_axes_error(const Eigen::Matrix3d& axes,
                                            const Eigen::Matrix3d& wanted);

/// Deviation of a body from the canonical T-pose.
struct TPoseResidual : BoneAxesError {
  std::string bone;  ///< Canonical bone.
  int body = 0;
};

/// The configuration closest to the canonical T-pose within the joint limits.
struct TPose {
  std::vector<double> qpos;  ///< In Robot's layout; the root is at its zero configuration.
  std::vector<TPoseResidual> residuals;  ///< Legs, then arms; left before right; from the trunk
                                         ///< outwards.
};

/// A canonical bone and the robot part that follows it.
struct BonePart {
  Bone bone = Bone::kHips;
  LimbPart part;
};

/// Returns all identified parts in the order of the published tables: pelvis, left and right leg,
/// torso (unless it is the pelvis), left and right arm, head.
[[nodiscard]] std::vector<BonePart> bone_parts(const RobotAnatomy& limbs);

/// Returns the world-from-bone rotation in this robot's T-pose: canonical_t_pose turned to the
/// robot's facing direction.
[[nodiscard]] Eigen::Matrix3d t_pose_of(const RobotAnatomy& limbs, Bone bone);

/// Explains why a robot cannot be retargeted to with this T-pose; nothing if it can. Faults are: a
/// limb segment or the trunk more than 25 degrees off in direction; a foot, hand or head more than
/// 60; a limb segment twisted by more than 120, so that its knee or elbow bends to the wrong side.
[[nodiscard]] std::optional<std::string> t_pose_fault(const Robot& robot, const TPose& t_pose);

/// Hint for such a fault.
inline constexpr const char* kTPoseHint =
    "check the ranges of its joints and of those before it, and the zero configuration, in which "
    "the "
    "robot must stand upright along z";

/// Solves for the T-pose within the model's ranges: bounded Levenberg-Marquardt on the angles
/// between the parts' bone axes and the canonical ones, with the joint axes as Jacobian. Starts
/// from the reference configuration and from raised and turned arms, and keeps the best result. If
/// a fault remains (t_pose_fault), also starts from that result with turned legs and arms. Joints
/// that affect no part keep their positions.
[[nodiscard]] TPose solve_t_pose(const Robot& robot, const RobotAnatomy& limbs);

}  // namespace retarget
