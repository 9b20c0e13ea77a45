#pragma once

#include <array>
#include <optional>
#include <string>

#include "retarget/clip.h"
#include "retarget/human.h"
#include "retarget/human_poser.h"

namespace retarget {

/// A robot's motion as a human's motion; input of clip_of_robot_human.
struct RobotHuman {
  std::string robot;  ///< Name of the robot.
  FrameRate rate;
  int frame_count = 0;
  HumanPose standing;          ///< Human pose in the configuration that defines the lengths.
  HumanPoseSource poses;       ///< Called twice per frame.
  BoneArray<bool> has{false};  ///< Available bones, without the two synthetic feet.
  std::array<std::optional<FootSole>, 2> soles;  ///< Left, right.
};

/// Makes a clip of such a motion. Its skeleton has one joint per bone with the bone's name, in
/// metres, Z up, and its zero pose is the T-pose (facing x). OFFSETs are positions in the standing
/// pose; bones of variable length have translations. The points of soles are end sites: the heel
/// and its tip at the foot, the tip at the toe, which is located at the sole's toe. The origin
/// names the robot.
///
/// human_of_robot restores the exact bones.
/// @param name  name of the clip.
[[nodiscard]] Clip clip_of_robot_human(const RobotHuman& human, const std::string& name);

/// Returns whether clip_of_robot_human made a clip: its bones are known and need no recognition.
[[nodiscard]] bool is_of_robot(const Clip& clip);

/// Returns the bones of such a clip.
[[nodiscard]] BoneMap bone_map_of_robot(const Clip& clip);
/// Returns the conversion of such a clip to the canonical human.
/// @param map  result of bone_map_of_robot
[[nodiscard]] Calibration calibration_of_robot(const Clip& clip, const BoneMap& map);

/// Determines the up axis of a robot's motion and sets it in the calibration. Motions of robots
/// have Z up. A motion that stands on a floor perpendicular to another axis, or falls along one,
/// was written in other axes: it is rotated, or the calibration gets a warning, by the same
/// evidence as for humans (choose_up).
/// @param clip  result of clip_of_robot_human
/// @param map   result of bone_map_of_robot
/// @param told  the user's up direction, which decides.
void settle_robot_up(const Clip& clip, const BoneMap& map,
                     const std::optional<Eigen::Vector3d>& told, Calibration& calibration);

}  // namespace retarget
