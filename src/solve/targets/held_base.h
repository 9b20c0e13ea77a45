#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "human/skeleton/human_clip.h"
#include "retarget/human.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"

namespace retarget {

/// The transform of a human for a robot with a fixed base (Robot::fixed_base). The base represents
/// the body part of the configuration's root bone. A base that represents the hips removes only
/// their position and heading, so the trunk leans relative to the vertical. A base that represents
/// the chest of an upper body removes the chest's whole rotation, so the arms move as they do
/// relative to the chest.
///
/// Let q be the root bone's world rotation and T its rotation for a human who stands facing +x. The
/// reference frame is q T^-1; for the hips, only its rotation about the vertical. Poses in this
/// frame are transferred unchanged to the frame in which the base has its own orientation when the
/// human stands facing +x.
class HeldBase {
 public:
  HeldBase(const Robot& robot, const ResolvedConfig& config);

  /// Rotation that transforms the human's world poses of this frame to those that the robot
  /// follows.
  [[nodiscard]] Eigen::Quaterniond turn(const HumanPose& world_from_bone) const;
  /// Position of the base, to which the root bone is moved; world, metres.
  [[nodiscard]] const Eigen::Vector3d& place() const { return place_; }

 private:
  Bone root_;
  Eigen::Quaterniond standing_from_root_;  // Equals T^-1.
  // Rotation from a human who stands facing +x to the base.
  Eigen::Quaterniond base_from_standing_;
  Eigen::Vector3d place_;
};

/// Returns nothing for a robot with a floating base.
[[nodiscard]] std::optional<HeldBase> held_base(const Robot& robot, const ResolvedConfig& config);

/// Transforms a human clip for a robot with a fixed base.
[[nodiscard]] HumanClip seen_by(const HeldBase& base, Bone root, HumanClip human);

}  // namespace retarget
