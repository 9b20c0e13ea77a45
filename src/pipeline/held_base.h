#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "human/human_clip.h"
#include "retarget/human.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// How a human is seen by a robot whose base stands fast (Robot::fixed_base): the base is the part of
/// the body that the configuration's root bone is. A base that stands for the hips takes their place and
/// heading alone, so that what the trunk leans, it leans from the vertical; a base that is the chest of
/// an upper body takes its whole rotation, and arms move as they move before the chest.
///
/// With q the root bone's world rotation and T that of a human who stands facing +x: the frame is
/// q T^-1, of the hips its twist about the vertical, and whatever is in that frame is the same in the
/// one in which the base stands as if the human stood so.
class HeldBase {
 public:
  HeldBase(const Robot& robot, const ResolvedConfig& config);

  /// world_from_seen: what turns the human of a frame to how the robot is to see it.
  [[nodiscard]] Eigen::Quaterniond turn(const HumanPose& world_from_bone) const;
  /// Where the base is, which the root bone is taken to; world, metres.
  [[nodiscard]] const Eigen::Vector3d& place() const { return place_; }

 private:
  Bone root_;
  Eigen::Quaterniond standing_from_root_;  // T^-1
  Eigen::Quaterniond base_from_standing_;  // a human who stands facing +x to how the base stands
  Eigen::Vector3d place_;
};

/// Nothing of a robot that moves about.
[[nodiscard]] std::optional<HeldBase> held_base(const Robot& robot, const ResolvedConfig& config);

/// A human as a robot sees it whose base stands fast.
[[nodiscard]] HumanClip seen_by(const HeldBase& base, Bone root, HumanClip human);

}  // namespace retarget
