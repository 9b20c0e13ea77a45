#pragma once

#include <optional>
#include <string>
#include <vector>

#include "human/skeleton/posed_body.h"
#include "retarget/human.h"

namespace retarget {

/// A pose and the body's axes in it.
struct RestCandidate {
  JointPoses pose;
  BodyFromFile axes = BodyFromFile::Identity();
  /// True: built with the skeleton rather than performed by a person. The soles of legs astride are
  /// then perpendicular to the shins and not on a floor.
  bool is_built = false;
};

/// Distance of a candidate from a T-pose, as angles in degrees: upper arms and forearms to the
/// lateral axis, thighs and shins to down, trunk to up. Yaw is ignored.
struct Deviation {
  double mean = 180.0;
  double largest = 180.0;
};
[[nodiscard]] Deviation deviation_from_t(const Body& body, const RestCandidate& candidate);

/// Returns whether a skeleton's maker may have built this pose: trunk up, straight legs down,
/// straight arms in the frontal plane anywhere from the thighs to slightly above the shoulders (T,
/// A or I), toes forward. Poses in which all bones point along a local axis, as in many zero poses,
/// do not qualify.
[[nodiscard]] bool is_well_formed(const Body& body, const RestCandidate& candidate);

/// Rotation of each mapped bone's canonical axes in its joint; empty for bones without a joint.
using JointFromBone = BoneArray<std::optional<Eigen::Matrix3d>>;

/// Brings a pose to the canonical T-pose and returns the axes of the canonical bones in the joints.
///
/// Trunk, neck and head do not move. Each clavicle, upper arm, thigh and shin turns by the
/// minimal rotation to its canonical direction. The upper arm's rotation also moves the forearm,
/// and the forearm's rotation the hand; so the arms of an A-pose rise about the body's forward axis
/// and keep their twist. Feet turn about the vertical until they point forward; in a built pose
/// after the shin's rotation.
[[nodiscard]] JointFromBone bring_to_t(const Body& body, const RestCandidate& candidate);

/// Returns the names of forearms without a hand or an end site away from the elbow.
[[nodiscard]] std::vector<std::string> forearms_without_length(const Body& body,
                                                               const JointPoses& pose);

/// Returns the sources of all canonical bones. Unmapped bones are attached rigidly to their
/// neighbours:
///
/// * Spine, Spine1, Spine2: the next mapped joint up the trunk; for Spine2 the next one down;
/// * Neck and Head: each other, with the head at the neck's end; a head whose position is unknown
///   is left out;
/// * collar bones: turn with the torso, at the upper arm's joint;
/// * hands: turn with the forearm, at its end site away from the elbow, or 0.8 upper arm lengths
///   along it;
/// * toes, also those with implausible rotations: turn with the foot, at their joint, at the foot's
///   end site, or 0.2 leg lengths along it (LAFAN1's proportion);
/// * the synthetic feet: at the ankle, turn with the toes.
///
/// @param axes  axes of the mapped bones
/// @param rest  a pose that gives the bone lengths
[[nodiscard]] BoneArray<BoneSource> bone_sources(const Body& body, const JointFromBone& axes,
                                                 const JointPoses& rest);

}  // namespace retarget
