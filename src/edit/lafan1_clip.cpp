#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "base/suggest.h"
#include "base/try.h"
#include "human/canonical_pose.h"
#include "human/human_clip.h"
#include "retarget/edit.h"

namespace retarget {
namespace {

constexpr double kPublishedHeight = 1.75;
constexpr double kCentimetresPerMetre = 100.0;

// parents of kBoneNames[0..21] in LAFAN1's tree
constexpr std::array<int, kMappedBoneCount> kParents = {-1, 0,  1,  2,  3,  0,  5,  6,  7,  0,  9,
                                                        10, 11, 12, 11, 14, 15, 16, 11, 18, 19, 20};

// y up from z up
Eigen::Quaterniond file_from_human() {
  Eigen::Matrix3d turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return Eigen::Quaterniond(turn);
}

// poses of all bones in a frame, those that are missing standing at their parents
std::array<Pose, kMappedBoneCount> whole_body(const HumanClip& human, int frame) {
  std::array<Pose, kMappedBoneCount> bones;
  const auto poses = human.frame(frame);
  for (int bone = 0; bone < kMappedBoneCount; ++bone) {
    bones[bone] = poses[bone];
    if (human.has(bone)) continue;
    const int parent = kParents[bone];
    const Eigen::Matrix3d parent_from_bone =
        canonical_t_pose(parent).transpose() * canonical_t_pose(bone);
    bones[bone] = {bones[parent].rotation * Eigen::Quaterniond(parent_from_bone).normalized(),
                   bones[parent].translation};
  }
  return bones;
}

std::shared_ptr<const Skeleton> make_skeleton(
    const std::array<Eigen::Vector3d, kMappedBoneCount>& offsets) {
  using enum Channel;
  std::vector<Joint> joints;
  for (int bone = 0; bone < kMappedBoneCount; ++bone) {
    Joint joint;
    joint.name = kBoneNames[bone];
    joint.parent = kParents[bone];
    joint.offset = offsets[bone];
    if (bone == 0) joint.channels = {kXPosition, kYPosition, kZPosition};
    joint.channels.insert(joint.channels.end(), {kZRotation, kYRotation, kXRotation});
    joints.push_back(std::move(joint));
  }
  return std::make_shared<const Skeleton>(std::move(joints));
}

Result<void> check_limbs(const HumanClip& human) {
  std::vector<std::string> missing;
  for (const char* part : {"UpLeg", "Leg", "Foot", "Arm", "ForeArm"}) {
    for (const std::string side : {"Left", "Right"}) {
      if (!human.has(find_bone(side + part).value())) missing.push_back(side + part);
    }
  }
  if (!human.has(0)) missing.emplace_back("Hips");
  if (missing.empty()) return {};
  return input_failure(
      {}, "a clip in LAFAN1's shape needs " + list_names(missing) + ", which the source lacks");
}

}  // namespace

Result<Clip> lafan1_clip(const Clip& source, const HumanMapping& mapping) {
  const HumanClip human = to_human(source, mapping);
  TRY(check_limbs(human));
  const double scale = kCentimetresPerMetre * kPublishedHeight / human.size;
  std::array<Eigen::Vector3d, kMappedBoneCount> offsets;
  offsets.fill(Eigen::Vector3d::Zero());
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const auto bones = whole_body(human, frame);
    for (int bone = 1; bone < kMappedBoneCount; ++bone) {
      const Pose& parent = bones[kParents[bone]];
      offsets[bone] += parent.rotation.conjugate() *
                       (bones[bone].translation - parent.translation) * (scale / human.frame_count);
    }
  }

  Clip clip(make_skeleton(offsets), human.rate, human.frame_count);
  const Eigen::Quaterniond turn = file_from_human();
  for (int frame = 0; frame < human.frame_count; ++frame) {
    const auto bones = whole_body(human, frame);
    const auto rotations = clip.rotations(frame);
    clip.translations(frame)[0] = turn * bones[0].translation * scale;
    for (int bone = 0; bone < kMappedBoneCount; ++bone) {
      rotations[bone] = bone == 0
                            ? turn * bones[0].rotation
                            : bones[kParents[bone]].rotation.conjugate() * bones[bone].rotation;
    }
  }
  return clip;
}

}  // namespace retarget
