#include "edit/rest_frames.h"

#include "retarget/human/bone_map.h"
#include "retarget/human/canonical_pose.h"

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

}  // namespace retarget
