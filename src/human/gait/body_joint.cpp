#include "human/gait/body_joint.h"

#include "retarget/human_skeleton.h"

namespace retarget {

int body_joint(const Skeleton& skeleton, const Calibration& calibration) {
  int moving = -1;
  int joint = calibration.bones[Bone::kHips].position_joint;
  for (; joint >= 0; joint = skeleton.joint(joint).parent) {
    if (skeleton.translation_slot(joint) >= 0) moving = joint;
  }
  return moving;
}

void move_body(Clip& clip, int frame, const Calibration& calibration, int joint,
               const Eigen::Vector3d& shift) {
  Eigen::Vector3d off =
      calibration.human_from_source.transpose() * shift / calibration.metres_per_unit;
  if (const int parent = clip.skeleton().joint(joint).parent; parent >= 0) {
    std::vector<Pose> world(static_cast<std::size_t>(clip.skeleton().joint_count()));
    forward_kinematics(clip, frame, world);
    off = world[static_cast<std::size_t>(parent)].rotation.conjugate() * off;
  }
  clip.translations(frame)[static_cast<std::size_t>(clip.skeleton().translation_slot(joint))] +=
      off;
}

}  // namespace retarget
