#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Where the joints of a skeleton are in some poses; file units and axes.
struct BodyPoses {
  struct Pose {
    std::vector<Eigen::Vector3d> joints;  ///< World positions.
    std::vector<Eigen::Vector3d> tips;    ///< Per joint its farthest end site, else the joint.
  };
  std::vector<Pose> poses;      ///< At least one.
  std::vector<double> lengths;  ///< Per joint the distance from its parent; 0 for the root.
  bool from_motion = false;     ///< False: the one pose is that of all rotations zero.
};

/// The skeleton with all rotations zero, which need not be a pose of a human.
[[nodiscard]] BodyPoses sample_zero_pose(const Skeleton& skeleton);

/// Frames spread evenly over a clip; the zero pose of a clip without frames.
[[nodiscard]] BodyPoses sample_poses(const Clip& clip);

}  // namespace retarget
