#include "retarget/edit/transfer.h"

#include <vector>

#include "edit/rest_frames.h"

namespace retarget {
namespace {

class Transfer {
 public:
  Transfer(const HumanClip& human, double raise, const TransferTarget& target)
      : human_(human),
        raise_(raise),
        target_(target),
        target_from_human_(Eigen::Quaterniond(target.mapping.human_from_source).conjugate()),
        bone_of_joint_(target.skeleton->joint_count(), -1),
        world_from_joint_(target.skeleton->joint_count()) {
    for (int bone = 0; bone < kMappedBoneCount; ++bone) {
      const int joint = target.map.joint_of_bone[static_cast<std::size_t>(bone)];
      if (joint >= 0 && human.has(bone)) bone_of_joint_[joint] = bone;
    }
    // where the path goes: the hips, or the next joint above that can be moved
    placed_joint_ = target.map.joint("Hips");
    while (placed_joint_ > 0 && target.skeleton->translation_slot(placed_joint_) < 0) {
      placed_joint_ = target.skeleton->joint(placed_joint_).parent;
    }
  }

  Clip run() {
    Clip clip(target_.skeleton, human_.rate, human_.frame_count);
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      turn_joints(clip, frame);
      place(clip, frame);
    }
    return clip;
  }

 private:
  void turn_joints(Clip& clip, int frame) {
    const auto poses = human_.frame(frame);
    const auto rotations = clip.rotations(frame);
    for (int joint = 0; joint < target_.skeleton->joint_count(); ++joint) {
      const int parent = target_.skeleton->joint(joint).parent;
      const Eigen::Quaterniond above =
          parent < 0 ? Eigen::Quaterniond::Identity() : world_from_joint_[parent].rotation;
      if (const int bone = bone_of_joint_[joint]; bone >= 0) {
        Eigen::Quaterniond world = target_from_human_ * poses[bone].rotation;
        const auto& axes = target_.mapping.bones[static_cast<std::size_t>(bone)].joint_from_bone;
        if (axes) world = world * axes->conjugate();
        rotations[joint] = (above.conjugate() * world).normalized();
      }
      const Pose parent_from_joint{rotations[joint], clip.translation(frame, joint)};
      world_from_joint_[joint] =
          parent < 0 ? parent_from_joint : world_from_joint_[parent] * parent_from_joint;
    }
  }

  // moves the placed joint so that the hips are where the human's are
  void place(Clip& clip, int frame) {
    const int slot = target_.skeleton->translation_slot(placed_joint_);
    if (slot < 0) return;
    Eigen::Vector3d wanted =
        human_.frame(frame)[0].translation * target_.mapping.size / human_.size;
    wanted.z() += raise_;
    const auto& beside = target_.mapping.bones[0].position_in_joint;
    const Eigen::Vector3d hips = world_from_joint_[target_.map.joint("Hips")] *
                                 (beside ? *beside : Eigen::Vector3d(Eigen::Vector3d::Zero()));
    const Eigen::Vector3d shift =
        target_from_human_ * wanted / target_.mapping.metres_per_unit - hips;
    const int parent = target_.skeleton->joint(placed_joint_).parent;
    const Eigen::Quaterniond above =
        parent < 0 ? Eigen::Quaterniond::Identity() : world_from_joint_[parent].rotation;
    clip.translations(frame)[slot] += above.conjugate() * shift;
  }

  const HumanClip& human_;
  const double raise_;  // of the hips, metres
  const TransferTarget& target_;
  const Eigen::Quaterniond target_from_human_;
  std::vector<int> bone_of_joint_;  // of target joints; -1: no bone
  int placed_joint_ = 0;
  std::vector<Pose> world_from_joint_;  // of the frame
};

}  // namespace

Clip transfer(const Clip& clip, const HumanMapping& mapping, const TransferTarget& target) {
  const auto depth = sole_depth(clip.skeleton(), mapping);
  const auto target_depth = sole_depth(*target.skeleton, target.mapping);
  const double scale = target.mapping.size / mapping.size;
  const double raise = depth && target_depth ? *target_depth - scale * *depth : 0.0;
  return Transfer(to_human(clip, mapping), raise, target).run();
}

}  // namespace retarget
