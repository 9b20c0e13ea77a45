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
/// Compares bone axes (columns X, Y, Z) with the desired ones.
[[nodiscard]] BoneAxesError bone_axes_error(const Eigen::Matrix3d& axes,
                                            const Eigen::Matrix3d& wanted);

/// Deviation of a body from the canonical T-pose.
struct TPoseResidual : BoneAxesError {
  std::string bone;  ///< Name of the canonical bone.
  int body = 0;      ///< Index into Robot::bodies().
};

/// The configuration closest to the canonical T-pose within the joint limits.
struct TPose {
  std::vector<double> qpos;  ///< Laid out as in RobotClip; the root is in its zero configuration.
  std::vector<TPoseResidual> residuals;  ///< Legs, then arms; left before right; from the trunk
                                         ///< outwards.
};

/// A canonical bone and the robot part that follows it.
struct BonePart {
  Bone bone = Bone::kHips;
  LimbPart part;
};

/// All identified parts in the order of the published tables: pelvis, left and right leg, torso
/// (unless it is the pelvis), left and right arm, head.
[[nodiscard]] std::vector<BonePart> bone_parts(const RobotAnatomy& limbs);

/// The rotation world_from_bone in the robot's T-pose: canonical_t_pose(), rotated to the robot's
/// facing direction.
[[nodiscard]] Eigen::Matrix3d t_pose_of(const RobotAnatomy& limbs, Bone bone);

/// Explains why retargeting to a robot with this T-pose is impossible; empty if it is possible.
/// Faults are: a direction error of a limb segment or the trunk above 25 degrees, or of a foot,
/// hand or head above 60 degrees; a twist error of a limb segment above 120 degrees, with which its
/// knee or elbow bends to the wrong side.
[[nodiscard]] std::optional<std::string> t_pose_fault(const Robot& robot, const TPose& t_pose);

/// Hint for the error message of a T-pose fault.
inline constexpr const char* kTPoseHint =
    "check the ranges of its joints and of those before it, and the zero configuration, in which "
    "the "
    "robot must stand upright along z";

/// Solves for the T-pose within the model's joint ranges by bounded Levenberg-Marquardt on the
/// differences between the parts' bone axes and the canonical ones. Starts from the reference
/// configuration with several rotations of the arms, and keeps the best result. If a fault remains
/// (t_pose_fault()), also starts from that result with rotated legs and arms. Joints that affect no
/// part keep their positions.
[[nodiscard]] TPose solve_t_pose(const Robot& robot, const RobotAnatomy& limbs);

}  // namespace retarget
