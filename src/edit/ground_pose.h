#pragma once

#include <optional>
#include <vector>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/ground_path.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {

/// Whether a joint has three position and three rotation channels.
[[nodiscard]] bool moves_freely(const Joint& joint);

/// Whether a joint is another one or hangs from it.
[[nodiscard]] bool is_at_or_below(const Skeleton& skeleton, int joint, int above);

/// A joint's pose in a frame, in the file's world; of -1 that of the world.
[[nodiscard]] Pose world_from_joint(const Clip& clip, int frame, int joint);

/// Moves the whole body of single frames, in the canonical human's world; only channels of one
/// joint change: the first one from the root to the hips that can be moved and turned freely, and is
/// in this clip. (A root that stands still above moving hips is a place of reference.)
class BodyMover {
 public:
  /// @param with  another clip of the skeleton that is to be moved by the same joint.
  /// @return a kInput error for a body that no joint moves as a whole.
  [[nodiscard]] static Result<BodyMover> of(const Clip& clip, const Calibration& calibration,
                                            const Clip* with = nullptr);

  /// @param move  of the world, metres, z up.
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

/// How far a rotation turns about the vertical (its twist), radians; nothing near to upside down.
[[nodiscard]] std::optional<double> heading_of(const Eigen::Quaterniond& turn);

/// Where the hips are over the ground in every frame. The heading is the hips' turn about the
/// vertical from the canonical T-pose that faces x (the twist of their rotation); it goes on
/// steadily from frame to frame, through whole turns too.
[[nodiscard]] std::vector<GroundPose> hips_over_ground(const HumanClip& human);

}  // namespace retarget
