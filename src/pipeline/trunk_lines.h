#pragma once

#include <Eigen/Core>
#include <optional>

#include "human/human_clip.h"
#include "retarget/human.h"

namespace retarget {

/// The lines of a trunk that every body has, human or robot, metres.
struct TrunkLines {
  /// From the middle of the hips to the middle of the shoulders.
  Eigen::Vector3d chord = Eigen::Vector3d::Zero();
  /// From the right shoulder to the left one.
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
};

/// The lines of a human in a frame, in the world.
/// @param world_from_bone  those of UpLeg and Arm count.
[[nodiscard]] TrunkLines trunk_lines(const HumanPose& world_from_bone);

/// World from trunk: z along the chord, y to the left as far as the shoulders say so. Nothing where
/// the lines are too short or along each other.
[[nodiscard]] std::optional<Eigen::Matrix3d> trunk_frame(const TrunkLines& lines);

/// The lines of a human who stands straight, in the axes of the canonical T-pose (x forward, y left,
/// z up): what a frame's lines are held against.
///
/// They are those of the T-pose, which skeletons differ in: where a skeleton has its hip and shoulder
/// joints is no posture. A T-pose of a straight spine is not how people stand, though; where a clip's
/// spine is bent as people's are (10 degrees from Hips to Spine2 in the lower quarter of the frames in
/// which hips and trunk are upright, nothing at 3), a chord that leans back in the T-pose counts as
/// upright when it is vertical. A robot's is upright as it is in the T-pose.
/// @pre the human has Hips, and UpLeg and Arm of both sides
/// @param poses  asked for some hundred frames at most.
[[nodiscard]] TrunkLines standing_trunk_lines(const HumanClipInfo& human,
                                              const HumanPoseSource& poses);

}  // namespace retarget
