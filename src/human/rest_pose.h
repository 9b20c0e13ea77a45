#pragma once

#include <optional>

#include "human/body_axes.h"
#include "human/posed_body.h"
#include "retarget/human.h"

namespace retarget {

/// A pose and the body's axes in it.
struct RestCandidate {
  JointPoses pose;
  BodyFromFile axes = BodyFromFile::Identity();
  /// Built with the skeleton rather than taken by a person: the soles of legs that stand astride
  /// are square to the shins then, and not on a floor.
  bool is_built = false;
};

/// How far a candidate is from a T-pose, as angles in degrees of upper arms and forearms to the
/// lateral axis, thighs and shins to down and the trunk to up; yaw is free.
struct Deviation {
  double mean = 180.0;
  double largest = 180.0;
};
[[nodiscard]] Deviation deviation_from_t(const Body& body, const RestCandidate& candidate);

/// Whether a pose is one that a skeleton's maker would build: trunk up, straight legs down, the
/// arms straight and in the body's frontal plane anywhere from the thighs to a little above the
/// shoulders (T, A or I), toes ahead. Bones pointing along a local axis whatever their place in
/// the body, as in many zero poses, are not.
[[nodiscard]] bool is_well_formed(const Body& body, const RestCandidate& candidate);

/// Rotation of each mapped bone's canonical axes in its joint; nothing for a bone without a joint.
using JointFromBone = BoneArray<std::optional<Eigen::Matrix3d>>;

/// Brings a pose to the canonical T-pose and tells the axes that the canonical bones have in the
/// joints then.
///
/// Trunk, neck and head are taken as they are. Each collar bone, upper arm, thigh and shin is
/// turned by the minimal rotation that takes it to its canonical direction, the upper arm's turn
/// carrying the forearm along and this one's the hand, so an A-pose's arms go up about the body's
/// forward axis and keep their twist. Feet are turned about the vertical until they point
/// ahead, in a built pose after the shin's turn.
[[nodiscard]] JointFromBone bring_to_t(const Body& body, const RestCandidate& candidate);

}  // namespace retarget
