#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/pose.h"

namespace retarget {

/// A point of a skeleton whose world pose can be asked for: a joint or an end site.
struct SkeletonPoint {
  std::string name;  ///< The joint's; of end sites `<joint>_end`, `<joint>_end2` and so on, without
                     ///< those that joints have as names.
  int joint = 0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< From the joint, in its frame.
};

/// All joints in order, each followed by its end sites.
[[nodiscard]] std::vector<SkeletonPoint> skeleton_points(const Skeleton& skeleton);

/// A joint, all that hang below it, and their end sites; nothing for a negative joint.
[[nodiscard]] std::vector<SkeletonPoint> points_below(const Skeleton& skeleton, int joint);

/// World pose of a point, given those of the joints; end sites are turned like their joint.
[[nodiscard]] Pose world_from_point(const SkeletonPoint& point,
                                    const std::vector<Pose>& world_from_joint);

/// The box around all joints and end sites over all frames, world axes, file units; of a clip
/// without frames, around the skeleton with all rotations zero.
[[nodiscard]] Eigen::AlignedBox3d extents(const Clip& clip);

}  // namespace retarget
