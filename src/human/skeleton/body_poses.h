#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Joint positions of a skeleton in several poses; file units and axes.
struct BodyPoses {
  struct Pose {
    std::vector<Eigen::Vector3d> joints;  ///< World positions.
    std::vector<Eigen::Vector3d> tips;  ///< Per joint: its farthest end site, or the joint itself.
  };
  std::vector<Pose> poses;  ///< At least one.
  /// Mean distance of each joint from its parent; 0 for the root and for joints that only position
  /// the body.
  std::vector<double> lengths;
  bool from_motion = false;  ///< False: the only pose has all rotations zero.
};

/// The pose with all rotations zero, which need not look human.
[[nodiscard]] BodyPoses sample_zero_pose(const Skeleton& skeleton);

/// At most 48 frames, spread evenly over the clip; the zero pose if the clip has no frames.
[[nodiscard]] BodyPoses sample_poses(const Clip& clip);

}  // namespace retarget
