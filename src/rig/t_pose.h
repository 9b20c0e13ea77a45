#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/limbs.h"
#include "retarget/human.h"
#include "retarget/robot.h"

namespace retarget {

/// How far a bone's axes are from others, rad.
struct BoneAxesError {
  double direction = 0.0;  ///< Angle between the X axes.
  double twist = 0.0;      ///< Angle that is left about X.
};
[[nodiscard]] BoneAxesError bone_axes_error(const Eigen::Matrix3d& axes,
                                            const Eigen::Matrix3d& wanted);

/// How far a body is from the canonical T-pose.
struct TPoseResidual : BoneAxesError {
  std::string bone;  ///< Canonical bone.
  int body = 0;
};

/// The configuration in which a robot stands in the canonical T-pose as well as its limits allow.
struct TPose {
  std::vector<double> qpos;  ///< Layout as Robot says; root where the zero configuration has it.
  std::vector<TPoseResidual> residuals;  ///< Legs, arms; left before right; from the trunk out.
};

/// A canonical bone, the part of the robot that follows it, and how much it counts.
struct BonePart {
  Bone bone = Bone::kHips;
  LimbPart part;
};

/// All parts that were found, in the order of the published tables: pelvis, left and right leg,
/// torso (unless it is the pelvis), left and right arm, head.
[[nodiscard]] std::vector<BonePart> bone_parts(const RobotAnatomy& limbs);

/// World from bone in the T-pose of this robot: canonical_t_pose turned to where the robot faces.
[[nodiscard]] Eigen::Matrix3d t_pose_of(const RobotAnatomy& limbs, Bone bone);

/// Why a robot whose T-pose this is cannot be retargeted to: a bone that stays more than 60 degrees
/// off in direction, or a segment of a limb turned by more than 120 about itself, so that its knee
/// or elbow bends to the wrong side. None: it can.
[[nodiscard]] std::optional<std::string> t_pose_fault(const Robot& robot, const TPose& t_pose);

/// What to look at then.
inline constexpr const char* kTPoseHint =
    "check the ranges of its joints and of those before it, and the zero configuration, in which "
    "the "
    "robot must stand upright along z";

/// Solves for the T-pose within the model's ranges: bounded Levenberg-Marquardt on the angles
/// between the parts' bone axes and the canonical ones, with the joint axes as Jacobian, from the
/// reference configuration and from raised and turned arms; the best result is taken. Joints that
/// no part needs stay where they are.
[[nodiscard]] TPose solve_t_pose(const Robot& robot, const RobotAnatomy& limbs);

}  // namespace retarget
