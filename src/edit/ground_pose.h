#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "human/human_clip.h"
#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/pose.h"

namespace retarget {

/// A place on the ground and a heading, or the rigid motion over the ground that leads from the
/// origin there: p goes to Rz(heading) p + position. In the canonical human's world (metres, x and
/// y on the ground, z up); of a y-up file x is the file's x and y its -z.
struct GroundPose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double heading = 0.0;  ///< Radians from x towards y.

  [[nodiscard]] GroundPose inverse() const;
  /// The rigid motion in space, metres.
  [[nodiscard]] Pose in_space() const;
};

[[nodiscard]] GroundPose operator*(const GroundPose& a, const GroundPose& b);
[[nodiscard]] Eigen::Vector2d operator*(const GroundPose& pose, const Eigen::Vector2d& point);

/// The motion that turns about a point on the ground.
[[nodiscard]] GroundPose turn_about(const Eigen::Vector2d& point, double angle);

/// Whether a joint has three position and three rotation channels.
[[nodiscard]] bool moves_freely(const Joint& joint);

/// Moves the whole body of single frames, in the canonical human's world; only channels of one
/// joint change: the first one from the root to the hips that can be moved and turned freely, and is
/// in this clip. (A root that stands still above moving hips is a place of reference.)
class BodyMover {
 public:
  /// @param file  for messages.
  /// @param with  another clip of the skeleton that is to be moved by the same joint.
  /// @return a kInput error for a body that no joint moves as a whole.
  [[nodiscard]] static Result<BodyMover> of(const Clip& clip, const HumanMapping& mapping,
                                            const std::string& file, const Clip* with = nullptr);

  /// @param move  of the world, metres, z up.
  void move(Clip& clip, int frame, const Pose& move) const;
  void move(Clip& clip, int frame, const GroundPose& over_ground) const {
    move(clip, frame, over_ground.in_space());
  }
  void move_all(Clip& clip, const Pose& over_all) const;

  [[nodiscard]] int joint() const { return joint_; }

 private:
  BodyMover(int joint, const HumanMapping& mapping);

  int joint_;
  double metres_per_unit_;
  Eigen::Quaterniond human_from_source_;
};

/// Where the hips are over the ground in every frame. The heading is the hips' turn about the
/// vertical from the canonical T-pose that faces x (the twist of their rotation); it goes on
/// steadily from frame to frame, through whole turns too.
[[nodiscard]] std::vector<GroundPose> hips_over_ground(const HumanClip& human);

}  // namespace retarget
