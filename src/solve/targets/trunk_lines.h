#pragma once

#include <Eigen/Core>
#include <optional>

#include "human/skeleton/human_clip.h"
#include "retarget/human.h"

namespace retarget {

/// Characteristic lines of the trunk of a human or a robot, metres.
struct TrunkLines {
  /// From the middle of the hips to the middle of the shoulders.
  Eigen::Vector3d chord = Eigen::Vector3d::Zero();
  /// From the right shoulder to the left one.
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
};

/// The lines of a human in a frame, world axes.
/// @param world_from_bone  reads only UpLeg and Arm.
[[nodiscard]] TrunkLines trunk_lines(const HumanPose& world_from_bone);

/// The rotation world_from_trunk with z along the chord and y as close to the shoulder line as
/// possible. Empty if the lines are too short or parallel.
[[nodiscard]] std::optional<Eigen::Matrix3d> trunk_frame(const TrunkLines& lines);

/// The lines of a human's trunk while it stands straight, in the axes of the canonical T-pose (x
/// forward, y left, z up). They are the reference for the lines of a frame.
///
/// They come from the T-pose, which removes differences between skeletons in the positions of hip
/// and shoulder joints. A T-pose has a straight spine, which is not a natural stance. In clips with
/// a naturally curved spine, a chord that leans back in the T-pose is therefore rotated to the
/// vertical. The measure of the curvature is the lower quartile of the angle between Hips and
/// Spine2 over frames with upright hips and trunk: no rotation below 3 degrees, the full rotation
/// above 10 degrees. The lines of a robot's human are those of its T-pose.
/// @pre the human has Hips, and UpLeg and Arm on both sides.
/// @param poses  called for at most about a hundred frames.
[[nodiscard]] TrunkLines standing_trunk_lines(const HumanClipInfo& human,
                                              const HumanPoseSource& poses);

}  // namespace retarget
