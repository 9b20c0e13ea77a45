#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/robot.h"

namespace retarget {

/// The body of a limb's part and where a canonical bone lies in it.
struct LimbPart {
  int body = 0;
  /// body_from_bone: the columns are the bone's X, Y and Z axes (canonical_pose.h) in the body's
  /// frame. Its transpose is the rotation offset of a retargeting configuration.
  Eigen::Matrix3d body_from_bone = Eigen::Matrix3d::Identity();
  /// Where the bone's joint lies in the body's frame, metres: hip, knee, ankle, shoulder, ...
  Eigen::Vector3d joint = Eigen::Vector3d::Zero();
};

/// A leg or an arm: two segments joined by one hinge, the knee or the elbow.
struct Limb {
  std::vector<int> joints;  ///< Indices into Robot::joints(), from the trunk outwards; no fingers.
  int middle = 0;           ///< Which of them is the knee or the elbow.
  LimbPart upper;           ///< Thigh or upper arm: the last body before the middle joint.
  LimbPart lower;           ///< Shin or forearm: the middle joint's body.
  /// Foot or hand: the last body that a joint beyond the middle moves; else, when a body is fixed
  /// to the end of the forearm, that one.
  std::optional<LimbPart> end;
  int end_joints = 0;               ///< Joints beyond the middle one.
  double upper_length = 0.0;        ///< Metres, across the middle joint's axis.
  double lower_length = 0.0;        ///< Metres, likewise.
  double straight = 0.0;            ///< Position of the middle joint with the limb straight, rad.
  double flexion = 1.0;             ///< Sign of the middle joint's positions that bend the limb.
  bool flexion_is_sure = true;      ///< The range says which way it bends; else its facing does.
  double clarity = 0.0;             ///< How far the best middle joint leads: 1 none other, 0 a tie.
  bool lower_is_estimated = false;  ///< Nothing lies beyond the middle joint but a centre of mass.
};

/// What of a robot is which part of a human.
struct RobotAnatomy {
  int pelvis = 0;  ///< The body that both legs hang from; without legs the base.
  int torso = 0;   ///< The body that both arms hang from; may be the pelvis.
  Eigen::Matrix3d pelvis_from_hips = Eigen::Matrix3d::Identity();   ///< As body_from_bone.
  Eigen::Matrix3d torso_from_spine2 = Eigen::Matrix3d::Identity();  ///< As body_from_bone.
  bool has_legs = true;      ///< Not that of a robot whose base stands fast.
  std::array<Limb, 2> legs;  ///< Left, right; without legs these have no joints.
  std::array<Limb, 2> arms;  ///< Left, right.
  std::optional<LimbPart> head;
  /// Directions in the world of the reference configuration: where the robot faces and its left.
  Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
  Eigen::Vector3d left = Eigen::Vector3d::UnitY();
  bool facing_is_sure = true;
  std::vector<std::string> notes;  ///< What was decided against the odds, for people.
};

/// The configuration that limbs are looked for in: the model's zero configuration with each joint
/// moved into its range.
[[nodiscard]] std::vector<double> reference_configuration(const Robot& robot);

/// Finds pelvis, torso, legs, arms and head by the tree and by where joints and axes lie; names
/// serve as one voice among others for which side is left. The reference configuration must
/// stand upright along z.
///
/// Legs are the pair of branches, mirror images of each other, that reaches lowest; arms the pair
/// of the others with the most joints. The knee or elbow of a branch is the hinge that splits its
/// joints into two clusters best: axes before it and after it meet in points far from it.
///
/// Of a robot whose base stands fast (Robot::fixed_base) only the arms are looked for, the pair that
/// hangs highest; legs, if it has some, and wheels are none of its limbs.
///
/// kConfig errors, one sentence each: an arm, a quadruped, wheels, no arms, a model that lies.
[[nodiscard]] Result<RobotAnatomy> find_limbs(const Robot& robot, const std::string& file);

}  // namespace retarget
