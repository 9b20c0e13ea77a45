#pragma once

#include <optional>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"

namespace retarget {

/// Returns true if a joint has three position and three rotation channels.
[[nodiscard]] bool moves_freely(const Joint& joint);

/// Returns the pose of a joint in a frame, in the file's world; joint -1 is the world itself.
[[nodiscard]] Pose world_from_joint(const Clip& clip, int frame, int joint);

/// Moves the whole body in single frames, in the canonical human's world. Changes only the channels
/// of one joint: the first one between root and hips with free translation and rotation that moves
/// in this clip. (A root that stays fixed above moving hips is only a reference frame.)
class BodyMover {
 public:
  /// @param with  another clip of the same skeleton that will be moved by the same joint.
  /// @return a kInput error if no joint moves the body as a whole.
  [[nodiscard]] static Result<BodyMover> of(const Clip& clip, const Calibration& calibration,
                                            const Clip* with = nullptr);

  /// @param move  motion in the world, metres, z up.
  void move(Clip& clip, int frame, const Pose& move) const;
  void move(Clip& clip, int frame, const GroundPose& over_ground) const {
    move(clip, frame, over_ground.in_space());
  }
  void move_all(Clip& clip, const Pose& over_all) const;

  [[nodiscard]] int joint() const { return joint_; }

 private:
  BodyMover(int joint, const Calibration& calibration);

  int joint_;
  double metres_per_unit_;
  Eigen::Quaterniond human_from_source_;
};

/// Returns the rotation about the vertical (twist), radians; nothing if close to upside down.
[[nodiscard]] std::optional<double> heading_of(const Eigen::Quaterniond& turn);

/// Returns the ground position of the hips in every frame. The heading is the hips' rotation about
/// the vertical (twist) relative to the canonical T-pose facing x; it is continuous from frame to
/// frame, also across full turns.
[[nodiscard]] std::vector<GroundPose> hips_over_ground(const HumanClip& human);

}  // namespace retarget
