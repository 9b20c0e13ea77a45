#pragma once

#include <Eigen/Core>
#include <optional>

#include "retarget/human.h"
#include "retarget/human_poser.h"

namespace retarget {

/// Characteristic lines of the trunk of a human or a robot, metres.
struct TrunkLines {
  /// Vector from the middle of the hips to the middle of the shoulders.
  Eigen::Vector3d chord = Eigen::Vector3d::Zero();
  /// Vector from the right shoulder to the left one.
  Eigen::Vector3d across = Eigen::Vector3d::Zero();
};

/// The lines of a human in a frame, world axes.
/// @param world_from_bone  reads only UpLeg and Arm.
[[nodiscard]] TrunkLines trunk_lines(const HumanPose& world_from_bone);

/// The rotation world_from_trunk with z along the chord and y as close to the shoulder line as
/// possible. Empty if the lines are too short or parallel.
[[nodiscard]] std::optional<Eigen::Matrix3d> trunk_frame(const TrunkLines& lines);

/// Whether the human has the bones of the trunk: Hips, and UpLeg and Arm on both sides.
[[nodiscard]] bool has_trunk(const HumanClipInfo& human);

/// The forward bend of the upper end of the spine relative to the hips while the human stands,
/// radians: the lower quartile over frames with upright hips and trunk. If these make less than a
/// second, the quartile over all frames counts for the rest of the second.
/// @pre has_trunk(human), and there is a frame.
/// @param poses  called for five frames per second.
[[nodiscard]] double standing_bend(const HumanClipInfo& human, const HumanPoseSource& poses);

/// The lines of a human's trunk while it stands straight, in the axes of the canonical T-pose (x
/// forward, y left, z up). They are the reference for the lines of a frame.
///
/// They come from the T-pose, which removes differences between skeletons in the positions of hip
/// and shoulder joints. A T-pose has a straight spine, which is not a natural stance. In clips with
/// a naturally curved spine, a chord that leans back in the T-pose is therefore rotated to the
/// vertical: not at all if standing_bend() is below 3 degrees, fully above 10 degrees. The lines of
/// a robot's human are those of its T-pose.
/// @pre has_trunk(human)
/// @param poses  called for at most about a hundred frames, and by standing_bend() if
///     HumanClipInfo::standing_bend is empty.
[[nodiscard]] TrunkLines standing_trunk_lines(const HumanClipInfo& human,
                                              const HumanPoseSource& poses);

}  // namespace retarget
