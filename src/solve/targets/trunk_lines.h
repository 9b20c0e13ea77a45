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
/// @param world_from_bone  only UpLeg and Arm are read.
[[nodiscard]] TrunkLines trunk_lines(const HumanPose& world_from_bone);

/// The rotation world_from_trunk: z along the chord, y to the left as close to the shoulder line as
/// possible. Returns nothing if the lines are too short or parallel.
[[nodiscard]] std::optional<Eigen::Matrix3d> trunk_frame(const TrunkLines& lines);

/// The lines of a human who stands straight, in the axes of the canonical T-pose (x forward, y
/// left, z up). The lines of a frame are compared with them.
///
/// They are derived from the T-pose, which removes differences between skeletons in the placement
/// of hip and shoulder joints. However, the straight spine of a T-pose is not a natural stance. If
/// a clip's spine bends as a human's does (fully from 10 degrees between Hips and Spine2 in the
/// lower quartile of the frames with upright hips and trunk, not at all below 3 degrees), a chord
/// that leans back in the T-pose is rotated to the vertical. For a robot, the T-pose is used
/// unchanged.
/// @pre the human has Hips, and UpLeg and Arm on both sides.
/// @param poses  called for about a hundred frames at most.
[[nodiscard]] TrunkLines standing_trunk_lines(const HumanClipInfo& human,
                                              const HumanPoseSource& poses);

}  // namespace retarget
