#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "human/twins.h"
#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"

namespace retarget {

/// A body in a zero pose, degrees from the T-pose.
struct ZeroShape {
  double lean = 0.0;                                      ///< Of the trunk, forward.
  double thigh = 0.0, knee = 0.0;                         ///< Thighs raised, knees bent.
  double arms_down = 0.0, arms_ahead = 0.0, elbow = 0.0;  ///< Of both arms.
  double astride = 0.0;                                   ///< Of both legs, outwards.
  double toes_down = 0.0;
  bool square_soles = false;  ///< Whether feet turn with the legs astride; else they are level.
};

inline Eigen::Quaterniond turned_by(double degrees, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180.0, axis));
}

/// Rotation of a bone from the T-pose to a shape, in the body's axes.
inline Eigen::Quaterniond turn_of(const ZeroShape& shape, Bone bone) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const auto part = limb_bone(bone);
  const Eigen::Quaterniond trunk = turned_by(shape.lean, y);
  if (!part) return trunk;
  const double side = side_of(bone) == Side::kLeft ? 1.0 : -1.0;
  const Eigen::Quaterniond arm =
      trunk * turned_by(-shape.arms_ahead, y) * turned_by(-side * shape.arms_down, x);
  const Eigen::Quaterniond leg = turned_by(side * shape.astride, x);
  switch (*part) {
    case LimbBone::kUpLeg:
      return leg * turned_by(-shape.thigh, y);
    case LimbBone::kLeg:
      return leg * turned_by(shape.knee - shape.thigh, y);
    case LimbBone::kFoot:
    case LimbBone::kToe:
    case LimbBone::kFootMod:
      return (shape.square_soles ? leg : Eigen::Quaterniond::Identity()) *
             turned_by(shape.toes_down, y);
    case LimbBone::kShoulder:
      return trunk;
    case LimbBone::kArm:
      return arm;
    default:
      return arm * turned_by(-side * shape.elbow, z);
  }
}

/// The twin of a LAFAN1-shaped clip (y up) with a shape as its zero pose.
/// @param twist  degrees about thighs and shins by which the file's axes are off, outwards.
inline Clip with_zero_shape(const Clip& clip, const ZeroShape& shape, double twist = 0.0) {
  const Eigen::Quaterniond file_from_human = turned_by(-90.0, Eigen::Vector3d::UnitX());
  std::vector<Eigen::Quaterniond> turns;
  for (const Joint& joint : clip.skeleton().joints()) {
    const Bone bone = bone_from_name(joint.name).value();
    const auto part = limb_bone(bone);
    const bool of_leg = part == LimbBone::kUpLeg || part == LimbBone::kLeg;
    const double side = side_of(bone) == Side::kLeft ? 1.0 : -1.0;
    const Eigen::Quaterniond axes(canonical_t_pose(bone));
    turns.push_back(turned_by(of_leg ? side * twist : 0.0, Eigen::Vector3d::UnitX()) *
                    (file_from_human * turn_of(shape, bone) * axes).inverse());
  }
  return with_other_axes(clip, turns);
}

/// The same joint positions of a LAFAN1-shaped clip, with thighs, shins, upper arms and forearms
/// that oscillate about their own axes. @param amplitude  degrees
inline Clip with_swinging_twists(const Clip& clip, double amplitude) {
  Clip twin = clip;
  const Skeleton& skeleton = clip.skeleton();
  std::vector<Pose> world(static_cast<std::size_t>(skeleton.joint_count()));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
      const auto part = limb_bone(bone_from_name(skeleton.joint(joint).name).value());
      const bool swings = part == LimbBone::kUpLeg || part == LimbBone::kLeg ||
                          part == LimbBone::kArm || part == LimbBone::kForeArm;
      const double angle = swings ? amplitude * std::sin(0.2 * frame + joint) : 0.0;
      Pose& pose = world[static_cast<std::size_t>(joint)];
      pose.rotation = pose.rotation * turned_by(angle, Eigen::Vector3d::UnitX());
      const int parent = skeleton.joint(joint).parent;
      twin.rotations(frame)[joint] =
          parent < 0
              ? pose.rotation
              : (world[static_cast<std::size_t>(parent)].rotation.conjugate() * pose.rotation)
                    .normalized();
    }
  }
  return twin;
}

/// Mean angle in degrees between the rotations of some bones of two humans.
inline double mean_turn(const HumanClip& a, const HumanClip& b, const std::vector<Bone>& bones) {
  double sum = 0.0;
  for (std::size_t frame = 0; frame < a.world_from_bone.size(); ++frame) {
    for (const Bone bone : bones) {
      const auto& turned = b.world_from_bone[frame][bone].rotation;
      sum += a.world_from_bone[frame][bone].rotation.angularDistance(turned);
    }
  }
  return sum * 180.0 / M_PI / static_cast<double>(a.world_from_bone.size() * bones.size());
}

}  // namespace retarget
