#include "retarget/clip.h"

namespace retarget {

void forward_kinematics(const Clip& clip, int frame, std::span<Pose> world_from_joint) {
  const Skeleton& skeleton = clip.skeleton();
  const auto rotations = clip.rotations(frame);
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const Pose parent_from_joint{rotations[joint], clip.translation(frame, joint)};
    const int parent = skeleton.joint(joint).parent;
    world_from_joint[joint] =
        parent < 0 ? parent_from_joint : world_from_joint[parent] * parent_from_joint;
  }
}

}  // namespace retarget
