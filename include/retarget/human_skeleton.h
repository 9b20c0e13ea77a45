#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/two_bone_leg.h"

namespace RETARGET_API retarget {

/// Returns whether `upper` is `joint` or one of its ancestors.
[[nodiscard]] bool is_above(const Skeleton& skeleton, int upper, int joint);

/// Returns the end site that is farthest from its joint. Returns zero without end sites.
[[nodiscard]] Eigen::Vector3d farthest_end(const Joint& joint);

/// Returns the joint whose rotation turns a bone.
///
/// This is the bone's own joint, with two exceptions. If the file's root is not at the hips (a
/// headset, for example), the tree between root and hips runs against the body; the joint that
/// turns the segment between two such joints is the one farther from the hips. If helper joints
/// coincide with the bone's joint, everything that the bone carries is attached to the last of
/// them, which includes the rotations of the others.
/// @return -1 for a bone without a joint
[[nodiscard]] int rotation_joint(const BoneMap& map, const Skeleton& skeleton, Bone bone);

/// Orientation of a bone (world from bone) in the canonical human's T-pose. World axes: x forward,
/// y left, z up. The columns are the bone's X, Y and Z axes:
///
///     Hips, Spine*, Neck, Head      up                      forward  left
///     UpLeg, Leg                    down                    forward  right
///     Foot                          forward, 25 deg down    up       right
///     Toe, FootMod                  forward                 up       right
///     left clavicle, arm, hand      left                    back     up
///     right clavicle, arm, hand     right                   back     down
///
/// These are the joint axes of LAFAN1's skeleton in a T-pose: X runs along the bone, as the
/// skeleton's OFFSETs do, and knees and elbows bend about -Z.
[[nodiscard]] Eigen::Matrix3d canonical_t_pose(Bone bone);

/// Returns the legs of a body, left and right; nothing if joints are missing or do not form a
/// chain.
[[nodiscard]] std::array<std::optional<LegJoints>, 2> find_legs(const Skeleton& skeleton,
                                                                const Calibration& calibration);

/// Like find_legs(), for arms: shoulder, elbow and wrist, in this order.
[[nodiscard]] std::array<std::optional<LegJoints>, 2> find_arms(const Skeleton& skeleton,
                                                                const Calibration& calibration);

}  // namespace retarget
