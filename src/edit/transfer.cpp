#include "edit/transfer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "edit/ground_pose.h"
#include "edit/plant_feet.h"
#include "edit/rest_frames.h"
#include "retarget/pose.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kSameLength = 1e-6;

// Returns true if a joint ever rotates, or translates relative to its OFFSET.
bool is_turned_or_moved(const Clip& clip, int joint) {
  const Eigen::Vector3d& offset = clip.skeleton().joint(joint).offset;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    if (1.0 - std::abs(clip.rotations(frame)[joint].w()) > kSameLength * kSameLength) return true;
    const double way = (clip.translation(frame, joint) - offset).norm();
    if (way > kSameLength * std::max(1.0, offset.norm())) return true;
  }
  return false;
}

// Marks the joints that define a bone's pose, including the helpers between them.
void mark_joints(const BoneSource& bone, const Skeleton& skeleton, std::vector<bool>& marked) {
  marked[bone.rotation_joint] = marked[bone.position_joint] = true;
  for (int joint = std::max(bone.rotation_joint, bone.twist_joint); joint > bone.position_joint;) {
    marked[joint] = true;
    joint = skeleton.joint(joint).parent;
  }
}

Eigen::Vector3d mean_translation(const Clip& clip, int joint) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int frame = 0; frame < clip.frame_count(); ++frame) sum += clip.translation(frame, joint);
  return sum / std::max(clip.frame_count(), 1);
}

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

// The canonical bone that each target joint turns, if the source has it.
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
  // A bone's rotation includes the twist of the joints inside it.
  for (const BoneSource& bone : target.calibration.bones) {
    for (int joint = bone.twist_joint; joint > bone.rotation_joint;) {
      shared.twins[joint] = -1;
      joint = skeleton.joint(joint).parent;
    }
  }
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

class Transfer {
 public:
  Transfer(const Clip& clip, const Calibration& calibration, double raise,
           const TransferTarget& target)
      : clip_(clip),
        human_(to_human(clip, calibration)),
        raise_(raise),
        units_(target.calibration.size / target.calibration.metres_per_unit *
               calibration.metres_per_unit / calibration.size),
        target_(target),
        target_from_human_(Eigen::Quaterniond(target.calibration.human_from_source).conjugate()),
        shared_(find_shared_joints(clip.skeleton(), calibration, target)),
        bone_of_joint_(bones_of_joints(calibration, target)),
        world_from_joint_(target.skeleton->joint_count()) {
    // Place the hips themselves, or the nearest ancestor that can be translated.
    placed_joint_ = target.map.joint(Bone::kHips);
    while (placed_joint_ > 0 && target.skeleton->translation_slot(placed_joint_) < 0) {
      placed_joint_ = target.skeleton->joint(placed_joint_).parent;
    }
    find_lengths();
  }

  Clip run() {
    Clip clip(target_.skeleton, human_.rate, human_.frame_count);
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      carry_translations(clip, frame);
      turn_joints(clip, frame);
      place(clip, frame);
    }
    return clip;
  }

 private:
  // Reference for the translations of matched joints: their OFFSET if it equals the target's,
  // otherwise their mean, because the OFFSETs then do not describe the same length.
  void find_lengths() {
    lengths_.assign(shared_.twins.size(), Eigen::Vector3d::Zero());
    for (int joint = 0; joint < target_.skeleton->joint_count(); ++joint) {
      const int twin = carried_from(joint);
      if (twin < 0) continue;
      const Eigen::Vector3d& offset = clip_.skeleton().joint(twin).offset;
      const Eigen::Vector3d scaled =
          units_ * (shared_.turn_above(*target_.skeleton, joint) * offset);
      const Eigen::Vector3d& wanted = target_.skeleton->joint(joint).offset;
      const bool same = (scaled - wanted).norm() <= 1e-3 * wanted.norm() + kSameLength;
      lengths_[joint] = same ? offset : mean_translation(clip_, twin);
    }
  }

  // Returns the source joint whose translations a target joint receives; -1: none.
  [[nodiscard]] int carried_from(int joint) const {
    const int twin = shared_.twins[joint];
    const bool both = twin >= 0 && target_.skeleton->translation_slot(joint) >= 0 &&
                      clip_.skeleton().translation_slot(twin) >= 0;
    return both ? twin : -1;
  }

  void carry_translations(Clip& clip, int frame) const {
    for (int joint = 0; joint < target_.skeleton->joint_count(); ++joint) {
      const int twin = carried_from(joint);
      if (twin < 0) continue;
      const Eigen::Vector3d way = clip_.translation(frame, twin) - lengths_[joint];
      clip.translations(frame)[target_.skeleton->translation_slot(joint)] +=
          units_ * (shared_.turn_above(*target_.skeleton, joint) * way);
    }
  }

  void turn_joints(Clip& clip, int frame) {
    const HumanPose& poses = human_.frame(frame);
    const auto rotations = clip.rotations(frame);
    for (int joint = 0; joint < target_.skeleton->joint_count(); ++joint) {
      const int parent = target_.skeleton->joint(joint).parent;
      const Eigen::Quaterniond above =
          parent < 0 ? Eigen::Quaterniond::Identity() : world_from_joint_[parent].rotation;
      if (const auto bone = bone_of_joint_[joint]) {
        Eigen::Quaterniond world = target_from_human_ * poses[*bone].rotation;
        const auto& axes = target_.calibration.bones[*bone].joint_from_bone;
        if (axes) world = world * axes->conjugate();
        rotations[joint] = (above.conjugate() * world).normalized();
      } else if (const int twin = shared_.twins[joint]; twin >= 0) {
        rotations[joint] = (shared_.turn_above(*target_.skeleton, joint) *
                            clip_.rotations(frame)[twin] * shared_.turns[joint].conjugate())
                               .normalized();
      }
      const Pose parent_from_joint{rotations[joint], clip.translation(frame, joint)};
      world_from_joint_[joint] =
          parent < 0 ? parent_from_joint : world_from_joint_[parent] * parent_from_joint;
    }
  }

  // Moves the placed joint so that the hips match the human's.
  void place(Clip& clip, int frame) {
    const int slot = target_.skeleton->translation_slot(placed_joint_);
    if (slot < 0) return;
    Eigen::Vector3d wanted =
        human_.frame(frame)[Bone::kHips].translation * target_.calibration.size / human_.size;
    wanted.z() += raise_;
    const auto& beside = target_.calibration.bones[Bone::kHips].position_in_joint;
    const Eigen::Vector3d hips = world_from_joint_[target_.map.joint(Bone::kHips)] *
                                 (beside ? *beside : Eigen::Vector3d(Eigen::Vector3d::Zero()));
    const Eigen::Vector3d shift =
        target_from_human_ * wanted / target_.calibration.metres_per_unit - hips;
    const int parent = target_.skeleton->joint(placed_joint_).parent;
    const Eigen::Quaterniond above =
        parent < 0 ? Eigen::Quaterniond::Identity() : world_from_joint_[parent].rotation;
    clip.translations(frame)[slot] += above.conjugate() * shift;
  }

  const Clip& clip_;
  const HumanClip human_;
  const double raise_;  // Height added to the hips, metres.
  const double units_;  // Target file units per source file unit, for bodies scaled to one size.
  const TransferTarget& target_;
  const Eigen::Quaterniond target_from_human_;
  const SharedJoints shared_;
  const std::vector<std::optional<Bone>> bone_of_joint_;  // One per target joint.
  std::vector<Eigen::Vector3d> lengths_;  // By target joint: reference translation of its match,
                                          // source units.
  int placed_joint_ = 0;
  std::vector<Pose> world_from_joint_;  // Poses of the current frame.
};

}  // namespace

Clip transfer(const Clip& clip, const Calibration& calibration, const TransferTarget& target) {
  const auto depth = sole_depth(clip.skeleton(), calibration);
  const auto target_depth = sole_depth(*target.skeleton, target.calibration);
  const double scale = target.calibration.size / calibration.size;
  const double raise = depth && target_depth ? *target_depth - scale * *depth : 0.0;
  return Transfer(clip, calibration, raise, target).run();
}

UncarriedJoints uncarried_joints(const Clip& clip, const Calibration& calibration,
                                 const TransferTarget& target) {
  const Skeleton &source = clip.skeleton(), &skeleton = *target.skeleton;
  const auto twins = find_shared_joints(source, calibration, target).twins;
  const auto bones = bones_of_joints(calibration, target);
  // Joints above the hips are part of the hips' world motion.
  const auto is_above_hips = [](const Skeleton& of, int joint, int hips) {
    return is_above(of, joint, hips);
  };
  UncarriedJoints result;
  std::vector<bool> carried(static_cast<std::size_t>(source.joint_count()), false),
      turned(static_cast<std::size_t>(skeleton.joint_count()), false);
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (twins[joint] >= 0) carried[twins[joint]] = turned[joint] = true;
    if (!bones[joint]) continue;
    mark_joints(calibration.bones[*bones[joint]], source, carried);
    mark_joints(target.calibration.bones[*bones[joint]], skeleton, turned);
  }
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (!turned[joint] && std::ranges::any_of(skeleton.joint(joint).channels, is_rotation) &&
        !is_above_hips(skeleton, joint, target.map.joint(Bone::kHips))) {
      result.at_rest.push_back(skeleton.joint(joint).name);
    }
  }
  for (int joint = 0; joint < source.joint_count(); ++joint) {
    if (carried[joint] ||
        is_above_hips(source, joint, calibration.bones[Bone::kHips].position_joint)) {
      continue;
    }
    if (is_turned_or_moved(clip, joint)) result.left_out.push_back(source.joint(joint).name);
  }
  return result;
}

Transferred transfer(const Subject& source, const Subject& target) {
  const TransferTarget onto{target.clip.shared_skeleton(), target.map, target.calibration};
  Transferred result{{transfer(source.clip, source.calibration, onto)}, {}, {}, {}};
  UncarriedJoints uncarried = uncarried_joints(source.clip, source.calibration, onto);
  for (const auto& [label, joints, of] : {std::tuple("left out", &uncarried.left_out, "target"),
                                          {"at rest", &uncarried.at_rest, "source"}}) {
    if (joints->empty()) continue;
    result.notes.push_back({label, list_names(*joints) + ": the " + of +
                                       " has no corresponding joint below the same parent"});
  }
  result.left_out = std::move(uncarried.left_out);
  result.at_rest = std::move(uncarried.at_rest);
  const auto feet = plant_transferred_feet(result.clip, onto, source.clip, source.calibration);
  if (feet) result.feet = *feet;
  result.notes.push_back(
      {"feet", feet ? planted_text(*feet) : "not planted: " + feet.error().message});
  return result;
}

}  // namespace retarget
