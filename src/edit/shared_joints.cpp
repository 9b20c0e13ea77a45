#include "edit/shared_joints.h"

#include <map>
#include <string>
#include <utility>

#include "edit/rest_frames.h"

namespace retarget {
namespace {

using JointKey = std::pair<std::string, std::string>;  // Name, parent's name.

JointKey key_of(const Skeleton& skeleton, int joint) {
  const int parent = skeleton.joint(joint).parent;
  return {skeleton.joint(joint).name, parent < 0 ? std::string() : skeleton.joint(parent).name};
}

// Joints with equal names and parent names are matched in order.
std::vector<int> find_twins(const Skeleton& source, const Skeleton& target) {
  std::map<JointKey, std::vector<int>> known;
  for (int joint = source.joint_count() - 1; joint >= 0; --joint) {
    known[key_of(source, joint)].push_back(joint);
  }
  std::vector<int> twins(static_cast<std::size_t>(target.joint_count()), -1);
  for (int joint = 0; joint < target.joint_count(); ++joint) {
    const auto found = known.find(key_of(target, joint));
    if (found == known.end() || found->second.empty()) continue;
    twins[joint] = found->second.back();
    found->second.pop_back();
  }
  return twins;
}

}  // namespace

std::vector<std::optional<Bone>> bones_of_joints(const Calibration& source,
                                                 const TransferTarget& target) {
  std::vector<std::optional<Bone>> bones(static_cast<std::size_t>(target.skeleton->joint_count()));
  // If a joint turns several bones, keep the one nearest to the hips: the others depend on it.
  for (auto at = kMappedBones.rbegin(); at != kMappedBones.rend(); ++at) {
    const Bone bone = *at;
    const BoneSource &from = source.bones[bone], &to = target.calibration.bones[bone];
    if (from.position_joint < 0 || from.rotation_joint < 0 || to.rotation_joint < 0) continue;
    // A bone without its own joint follows its neighbour.
    if (to.position_joint != target.map.joint(bone)) continue;
    bones[to.rotation_joint] = bone;
  }
  return bones;
}

SharedJoints find_shared_joints(const Skeleton& source, const Calibration& calibration,
                                const TransferTarget& target) {
  const Skeleton& skeleton = *target.skeleton;
  const Eigen::Quaterniond human_from_source(calibration.human_from_source),
      human_from_target(target.calibration.human_from_source);
  SharedJoints shared{find_twins(source, skeleton), {}, {}};
  shared.world_turn = human_from_target.conjugate() * human_from_source;
  const auto bones = bones_of_joints(calibration, target);
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const Eigen::Quaterniond above = shared.turn_above(skeleton, joint);
    if (const auto bone = bones[joint]) {
      const auto axes = [bone](const Calibration& of) {
        return of.bones[*bone].joint_from_bone.value_or(Eigen::Quaterniond::Identity());
      };
      shared.turns.push_back(axes(target.calibration) * axes(calibration).conjugate());
    } else if (shared.twins[joint] >= 0) {
      const Eigen::Quaterniond turn =
          rest_turn(leaving_of(source, skeleton, shared.twins, joint, above)) * above;
      shared.turns.push_back(turn.normalized());
    } else {
      shared.turns.push_back(above);
    }
  }
  return shared;
}

}  // namespace retarget
