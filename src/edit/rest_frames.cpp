#include "edit/rest_frames.h"

#include <algorithm>

#include "retarget/human/bone_map.h"
#include "retarget/human/canonical_pose.h"
#include "retarget/motion/skeleton_points.h"

namespace retarget {

std::vector<Eigen::Quaterniond> t_pose_rotations(const Skeleton& skeleton,
                                                 const HumanMapping& mapping) {
  std::vector<int> bones(static_cast<std::size_t>(skeleton.joint_count()), -1);
  for (int bone = kMappedBoneCount - 1; bone >= 0; --bone) {
    const int joint = mapping.bones[static_cast<std::size_t>(bone)].rotation_joint;
    if (joint >= 0) bones[joint] = bone;
  }
  const Eigen::Quaterniond human_from_source(mapping.human_from_source);
  std::vector<Eigen::Quaterniond> rotations;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (bones[joint] >= 0) {
      Eigen::Quaterniond turn(canonical_t_pose(bones[joint]));
      const auto& axes = mapping.bones[static_cast<std::size_t>(bones[joint])].joint_from_bone;
      if (axes) turn = turn * axes->conjugate();
      rotations.push_back(turn.normalized());
    } else {
      const int parent = skeleton.joint(joint).parent;
      rotations.push_back(parent < 0 ? human_from_source : rotations[parent]);
    }
  }
  return rotations;
}

std::optional<double> sole_depth(const Skeleton& skeleton, const HumanMapping& mapping) {
  const int hips = mapping.bones[0].position_joint;
  if (hips < 0) return std::nullopt;
  const auto turns = t_pose_rotations(skeleton, mapping);
  std::vector<Eigen::Vector3d> places;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const int parent = skeleton.joint(joint).parent;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    if (parent >= 0) place = places[parent] + turns[parent] * skeleton.joint(joint).offset;
    places.push_back(place);
  }
  std::optional<double> lowest;
  for (const char* foot : {"LeftFoot", "RightFoot"}) {
    const int ankle =
        mapping.bones[static_cast<std::size_t>(find_bone(foot).value())].position_joint;
    for (const SkeletonPoint& point : points_below(skeleton, ankle)) {
      const Eigen::Vector3d place = places[point.joint] + turns[point.joint] * point.offset;
      lowest = std::min(lowest.value_or(place.z()), place.z());
    }
  }
  if (!lowest) return std::nullopt;
  Eigen::Vector3d origin = places[hips];
  if (const auto& beside = mapping.bones[0].position_in_joint) origin += turns[hips] * *beside;
  return (origin.z() - *lowest) * mapping.metres_per_unit;
}

}  // namespace retarget
