#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// The body of a limb part and the pose of a canonical bone in it.
struct LimbPart {
  int body = 0;
  /// body_from_bone: the columns are the bone's X, Y and Z axes (canonical_t_pose) in the body's
  /// frame. Its transpose is the rotation offset of a retargeting configuration.
  Eigen::Matrix3d body_from_bone = Eigen::Matrix3d::Identity();
  /// Position of the bone's joint (hip, knee, ankle, shoulder, ...) in the body's frame, metres.
  Eigen::Vector3d joint = Eigen::Vector3d::Zero();
};

/// A leg or an arm: two segments joined by one hinge, the knee or the elbow.
struct Limb {
  std::vector<int> joints;  ///< Indices into Robot::joints(), from the trunk outwards, without
                            ///< fingers.
  int middle = 0;           ///< Index in `joints` of the knee or elbow.
  LimbPart upper;           ///< Thigh or upper arm: the last body before the middle joint.
  LimbPart lower;           ///< Shin or forearm: the middle joint's body.
  /// Foot or hand: the last body moved by a joint beyond the middle, otherwise a body fixed to the
  /// end of the forearm.
  std::optional<LimbPart> end;
  int end_joints = 0;           ///< Number of joints beyond the middle one.
  double upper_length = 0.0;    ///< Metres, perpendicular to the middle joint's axis.
  double lower_length = 0.0;    ///< Metres, likewise.
  double straight = 0.0;        ///< Position of the middle joint that makes the limb straight, rad.
  double flexion = 1.0;         ///< Sign of the middle joint positions that bend the limb.
  bool flexion_is_sure = true;  ///< True if the range gives the bending direction, false if the
                                ///< facing does.
  double clarity = 0.0;         ///< Margin of the best middle joint: 1 no alternative, 0 a tie.
  bool lower_is_estimated = false;  ///< True if only a centre of mass marks the end of the lower
                                    ///< segment.
};

/// Assignment of robot bodies to human body parts.
struct RobotAnatomy {
  int pelvis = 0;  ///< The body that carries both legs; without legs, the base.
  int torso = 0;   ///< The body that carries both arms; may be the pelvis.
  Eigen::Matrix3d pelvis_from_hips = Eigen::Matrix3d::Identity();   ///< Like body_from_bone.
  Eigen::Matrix3d torso_from_spine2 = Eigen::Matrix3d::Identity();  ///< Like body_from_bone.
  bool has_legs = true;      ///< False for a fixed-base robot.
  std::array<Limb, 2> legs;  ///< Left, right; without joints if the robot has no legs.
  std::array<Limb, 2> arms;  ///< Left, right.
  std::optional<LimbPart> head;
  /// Facing direction and the robot's left, in the world frame of the reference configuration.
  Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
  Eigen::Vector3d left = Eigen::Vector3d::UnitY();
  bool facing_is_sure = true;
  std::vector<std::string> notes;   ///< Human-readable: unusual decisions.
  std::vector<std::string> doubts;  ///< Human-readable: ambiguous limbs, unequal sides.
};

/// A Limb::clarity below this raises a warning: another joint fits nearly as well.
inline constexpr double kClearMiddle = 0.3;

/// Returns the configuration in which limbs are identified: the model's zero configuration with
/// each joint clamped to its range.
[[nodiscard]] std::vector<double> reference_configuration(const Robot& robot);

/// Finds pelvis, torso, legs, arms and head from the tree and the positions of joints and axes;
/// names only contribute to the choice of the left side. The reference configuration must stand
/// upright along z. Feet whose contact geoms are not level in it get the direction of their
/// underside (foot_tilt).
///
/// The legs are the mirrored pair of branches that reaches lowest; the arms are the remaining pair
/// with the most joints. The knee or elbow of a branch is the hinge that best splits its joints
/// into two clusters: the axes before it and after it intersect in points far from it.
///
/// For a fixed-base robot (Robot::fixed_base) only the arms are identified, as the highest pair;
/// its legs and wheels, if any, are ignored.
///
/// Errors (kConfig), one sentence each: a single arm, a quadruped, wheels, no arms, a model that
///   lies down.
[[nodiscard]] Result<RobotAnatomy> find_limbs(const Robot& robot, const std::string& file);

}  // namespace retarget
