#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "retarget/clip.h"
#include "retarget/edit.h"
#include "retarget/human.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

constexpr double kPublishedHeight = 1.75;
constexpr double kCentimetresPerMetre = 100.0;

// Parents in LAFAN1's tree, by kMappedBones; the hips are the root and their entry is unused.
constexpr std::array kParents = {
    Bone::kHips,      Bone::kHips,        Bone::kLeftUpLeg,  Bone::kLeftLeg,
    Bone::kLeftFoot,  Bone::kHips,        Bone::kRightUpLeg, Bone::kRightLeg,
    Bone::kRightFoot, Bone::kHips,        Bone::kSpine,      Bone::kSpine1,
    Bone::kSpine2,    Bone::kNeck,        Bone::kSpine2,     Bone::kLeftShoulder,
    Bone::kLeftArm,   Bone::kLeftForeArm, Bone::kSpine2,     Bone::kRightShoulder,
    Bone::kRightArm,  Bone::kRightForeArm};
static_assert(kParents.size() == kMappedBoneCount);

Bone parent_of(Bone bone) {
  return kParents[static_cast<std::size_t>(bone)];
}

// Rotates z up to y up.
Eigen::Quaterniond file_from_human() {
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return Eigen::Quaterniond(turn);
}

// Returns the poses of all bones in a frame; missing bones are placed at their parents.
HumanPose whole_body(const HumanClip& human, int frame) {
  HumanPose bones;
  const HumanPose& poses = human.frame(frame);
  for (const Bone bone : kMappedBones) {
    bones[bone] = poses[bone];
    if (human.has(bone)) continue;
    const Bone parent = parent_of(bone);
    const Eigen::Matrix3d parent_from_bone =
        canonical_t_pose(parent).transpose() * canonical_t_pose(bone);
    bones[bone] = {bones[parent].rotation * Eigen::Quaterniond(parent_from_bone).normalized(),
                   bones[parent].translation};
  }
  return bones;
}

std::shared_ptr<const Skeleton> make_skeleton(const BoneArray<Eigen::Vector3d>& offsets) {
  using enum Channel;
  std::vector<Joint> joints;
  for (const Bone bone : kMappedBones) {
    Joint joint;
    joint.name = bone_name(bone);
    joint.parent = bone == Bone::kHips ? -1 : static_cast<int>(parent_of(bone));
    joint.offset = offsets[bone];
    if (bone == Bone::kHips) joint.channels = {kXPosition, kYPosition, kZPosition};
    joint.channels.insert(joint.channels.end(), {kZRotation, kYRotation, kXRotation});
    joints.push_back(std::move(joint));
  }
  return std::make_shared<const Skeleton>(std::move(joints));
}

Result<void> check_limbs(const HumanClip& human) {
  std::vector<std::string> missing;
  for (const LimbBone part :
       {LimbBone::kUpLeg, LimbBone::kLeg, LimbBone::kFoot, LimbBone::kArm, LimbBone::kForeArm}) {
    for (const Side side : kSides) {
      if (!human.has(side_bone(side, part))) missing.emplace_back(bone_name(side_bone(side, part)));
    }
  }
  if (!human.has(Bone::kHips)) missing.emplace_back(bone_name(Bone::kHips));
  if (missing.empty()) return {};
  return input_failure(
      {}, "the LAFAN1 skeleton needs " + list_names(missing) + ", which the source lacks");
}

}  // namespace

Result<Clip> lafan1_clip(const Clip& source, const Calibration& calibration) {
  const HumanClip human = to_human(source, calibration);
  RETARGET_TRY(check_limbs(human));
  const double scale = kCentimetresPerMetre * kPublishedHeight / human.size;
  BoneArray<Eigen::Vector3d> offsets{Eigen::Vector3d(Eigen::Vector3d::Zero())};
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const HumanPose bones = whole_body(human, frame);
    for (const Bone bone : std::span(kMappedBones).subspan<1>()) {
      const Pose& parent = bones[parent_of(bone)];
      offsets[bone] += parent.rotation.conjugate() *
                       (bones[bone].translation - parent.translation) * (scale / human.frame_count);
    }
  }

  Clip clip(make_skeleton(offsets), human.rate, human.frame_count);
  const Eigen::Quaterniond turn = file_from_human();
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const HumanPose bones = whole_body(human, frame);
    const auto rotations = clip.rotations(frame);
    clip.translations(frame)[0] = turn * bones[Bone::kHips].translation * scale;
    for (const Bone bone : kMappedBones) {
      rotations[static_cast<std::size_t>(bone)] =
          bone == Bone::kHips ? turn * bones[Bone::kHips].rotation
                              : bones[parent_of(bone)].rotation.conjugate() * bones[bone].rotation;
    }
  }
  return clip;
}

}  // namespace retarget
