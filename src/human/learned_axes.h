#pragma once

#include <vector>

#include "human/rest_pose.h"

namespace retarget {

/// Axes of the canonical bones in their joints from a whole movement, for skeletons without a rest
/// pose that could be taken. All of it follows from positions and from how joints turn, so the
/// choice of local axes does not matter.
///
/// * X of limbs, collar bones, feet, neck and the spine's joints runs along the bone.
/// * Knees and elbows bend about -Z: Z is the mean, over the frames, of the bending plane's normal
///   (weighted by the sine of the bend), for thigh, shin, upper arm, forearm and hand. Those of
///   LAFAN1's arms stand off their Z by 13 (upper arm), 10 (forearm) and 38 degrees (hand: people
///   hardly ever hold their palms down) on average over twelve of its clips, turned outwards;
///   the same is taken off here.
/// * Z of hips and torso is the mean hip and shoulder line. X of the hips and of the head is the
///   mean vertical of frames in which the trunk is upright (within 25 degrees).
/// * Y of the toes is the mean vertical while the foot stands flat: its ankle as low as in the
///   lowest tenth of the frames and the shin upright.
///
/// Bones of which the movement shows too little (arms that never bend) keep the axes of `best`.
/// @param poses  not empty.
/// @param up     the file's up axis, unit length.
/// @param best   the pose nearest to a T-pose.
[[nodiscard]] JointFromBone learned_axes(const Body& body, const std::vector<JointPoses>& poses,
                                         const Eigen::Vector3d& up, const RestCandidate& best);

/// Axes of a rest pose, with those of upper arm, forearm and hand learned where the movement bends
/// the elbow more than 20 degrees off: arms of a rest pose may be turned any way about themselves.
/// @param poses  may be empty.
[[nodiscard]] JointFromBone with_corrected_arms(const Body& body,
                                                const std::vector<JointPoses>& poses,
                                                const Eigen::Vector3d& up, JointFromBone axes);

}  // namespace retarget
