#pragma once

#include <array>
#include <optional>
#include <string>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/human.h"

namespace retarget {

/// A robot's motion as a human's: what a clip of it is made of.
struct RobotHuman {
  std::string robot;  ///< Its name.
  FrameRate rate;
  int frame_count = 0;
  HumanPose standing;          ///< In the configuration that its lengths are those of.
  HumanPoseSource poses;       ///< Asked for each frame twice.
  BoneArray<bool> has{false};  ///< The bones that it has; not the two synthetic feet.
  std::array<std::optional<FootSole>, 2> soles;  ///< Left, right.
};

/// The clip of such a motion: a skeleton with a joint for each bone and under its name, metres, Z up,
/// whose zero pose is the T-pose (facing x). OFFSETs are places as the body stands; bones that do not
/// keep them have translations. The points of soles are end sites: heel and its tip of
/// the foot, the tip of the toe, which stands where the sole's toe is. The origin names the robot.
///
/// human_of_robot gives the very bones back.
/// @param name  of the clip.
[[nodiscard]] Clip clip_of_robot_human(const RobotHuman& human, const std::string& name);

/// Whether a clip is one of clip_of_robot_human: what its bones are is known and not looked for.
[[nodiscard]] bool is_of_robot(const Clip& clip);

/// The bones of such a clip.
[[nodiscard]] BoneMap bone_map_of_robot(const Clip& clip);
/// What makes it the canonical human. @param map  bone_map_of_robot's
[[nodiscard]] Calibration calibration_of_robot(const Clip& clip, const BoneMap& map);

}  // namespace retarget
