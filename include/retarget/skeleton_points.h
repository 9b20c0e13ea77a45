#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "retarget/clip.h"
#include "retarget/export.h"
#include "retarget/pose.h"

namespace RETARGET_API retarget {

/// A point of a skeleton: a joint or an end site.
struct SkeletonPoint {
  std::string name;  ///< Name of the joint; end sites are named `<joint>_end`, `<joint>_end2` and
                     ///< so on, without names that joints have.
  int joint = 0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Offset from the joint, in its frame, file
                                                     ///< units.
};

/// All joints in order, each followed by its end sites.
[[nodiscard]] std::vector<SkeletonPoint> skeleton_points(const Skeleton& skeleton);

/// A joint, its descendants and their end sites; empty for a negative joint.
[[nodiscard]] std::vector<SkeletonPoint> points_below(const Skeleton& skeleton, int joint);

/// World pose of a point, from those of the joints. End sites have the rotation of their joint.
[[nodiscard]] Pose world_from_point(const SkeletonPoint& point,
                                    const std::vector<Pose>& world_from_joint);

/// The bounding box of all joints and end sites over all frames, world axes, file units. For a clip
/// without frames, that of the skeleton with zero rotations.
[[nodiscard]] Eigen::AlignedBox3d extents(const Clip& clip);

}  // namespace retarget
