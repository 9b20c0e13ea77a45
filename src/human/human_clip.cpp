#include "human/human_clip.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/suggest.h"
#include "human/lafan1_shape.h"
#include "motion/forward_kinematics.h"

namespace retarget {
namespace {

// joint of the first of these names that the skeleton has
int find_joint(const Skeleton& skeleton, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    if (const std::optional<int> joint = skeleton.find(name)) return *joint;
  }
  return -1;
}

BoneSource lafan1_source(const Skeleton& skeleton, std::string_view bone) {
  for (const std::string side : {"Left", "Right"}) {
    const int toe = find_joint(skeleton, {side + "Toe", side + "ToeBase"});
    if (bone == side + "Toe") return {toe, toe};
    if (bone == side + "FootMod") {
      const int foot = find_joint(skeleton, {side + "Foot"});
      return foot < 0 || toe < 0 ? BoneSource{} : BoneSource{foot, toe};
    }
  }
  const int joint = find_joint(skeleton, {bone});
  return {joint, joint};
}

// offsets that leave their axis by more than 20 degrees are not LAFAN1's
constexpr double kLeastAxisShare = 0.93969262078590838;  // cosine of that angle
bool runs_along(const Eigen::Vector3d& offset, int axis) {
  return offset[axis] > kLeastAxisShare * offset.norm();
}

}  // namespace

std::vector<std::string> bones_off_lafan1_axes(const Skeleton& skeleton,
                                               const JointOfBone& joint_of) {
  std::vector<std::string> off_axis;
  for (const char* name : {"LeftLeg", "LeftFoot", "RightLeg", "RightFoot", "LeftForeArm",
                           "LeftHand", "RightForeArm", "RightHand"}) {
    const std::optional<int> joint = joint_of(name);
    if (joint && !runs_along(skeleton.joint(*joint).offset, 0)) off_axis.emplace_back(name);
  }
  for (const char* name : {"UpLeg", "Shoulder"}) {
    const std::optional<int> left = joint_of(std::string("Left") + name);
    const std::optional<int> right = joint_of(std::string("Right") + name);
    if (!left || !right) continue;
    const Eigen::Vector3d across = skeleton.joint(*left).offset - skeleton.joint(*right).offset;
    if (!runs_along(across, 2)) off_axis.push_back(std::string("Left/Right") + name);
  }
  return off_axis;
}

double lafan1_leg_length(const Skeleton& skeleton, const JointOfBone& joint_of) {
  const std::optional<int> knee = joint_of("LeftLeg"), ankle = joint_of("LeftFoot");
  if (!knee || !ankle) return 0.0;
  return skeleton.joint(*knee).offset.norm() + skeleton.joint(*ankle).offset.norm();
}

bool is_leg_in_centimetres(double length) {
  constexpr double kShortest = 45.0, kLongest = 130.0;
  return length >= kShortest && length <= kLongest;
}

namespace {

// what the offsets say against a skeleton being LAFAN1's: names alone prove little
std::vector<Warning> lafan1_doubts(const Skeleton& skeleton) {
  const JointOfBone by_name = [&](std::string_view bone) { return skeleton.find(bone); };
  const std::vector<std::string> off_axis = bones_off_lafan1_axes(skeleton, by_name);
  std::vector<Warning> doubts;
  if (!off_axis.empty()) {
    doubts.push_back({0, 0,
                      "the joints have LAFAN1's names but not its axes (limbs along x, sides "
                      "apart along z): " +
                          list_names(off_axis) + "; expect twisted limbs"});
  }
  const double leg = lafan1_leg_length(skeleton, by_name);
  if (leg > 0.0 && !is_leg_in_centimetres(leg)) {
    doubts.push_back({0, 0,
                      "a leg of " + std::to_string(leg) +
                          " units is no human leg in centimetres: the file has another "
                          "unit, and positions will be wrong"});
  }
  return doubts;
}

HumanMapping published_mapping(std::vector<BoneSource> bones) {
  HumanMapping mapping;
  mapping.dialect = "lafan1";
  mapping.bones = std::move(bones);
  mapping.metres_per_unit = 0.01;
  // a quarter turn about x takes y (up) to z
  mapping.human_from_source << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  mapping.height = 1.75;
  mapping.description =
      "LAFAN1 skeleton, centimetres, Y up, body height 1.75 m as the published method has it";
  return mapping;
}

}  // namespace

Result<HumanMapping> lafan1_mapping(const Skeleton& skeleton, const std::string& file) {
  for (const std::string_view bone : kBoneNames) {
    if (std::ranges::count(skeleton.joints(), bone, &Joint::name) > 1) {
      return input_failure(file,
                           "several joints are called \"" + std::string(bone) +
                               "\": which of them is the bone cannot be told",
                           "rename all but one of them");
    }
  }
  std::vector<BoneSource> bones;
  bones.reserve(kBoneCount);
  for (const std::string_view bone : kBoneNames) bones.push_back(lafan1_source(skeleton, bone));
  HumanMapping mapping = published_mapping(std::move(bones));
  mapping.doubts = lafan1_doubts(skeleton);
  return mapping;
}

HumanMapping lafan1_mapping(const BoneMap& map) {
  std::vector<BoneSource> bones;
  for (const int joint : map.joint_of_bone) bones.push_back({joint, joint});
  for (const std::string side : {"Left", "Right"}) {
    const int foot = map.joint(side + "Foot"), toe = map.joint(side + "Toe");
    bones.push_back(foot < 0 || toe < 0 ? BoneSource{} : BoneSource{foot, toe});
  }
  return published_mapping(std::move(bones));
}

HumanPoser::HumanPoser(const Clip& clip, const HumanMapping& mapping)
    : clip_(clip),
      mapping_(mapping),
      turn_(mapping.human_from_source),
      world_from_joint_(clip.skeleton().joint_count()) {}

HumanClipInfo HumanPoser::info() const {
  const Skeleton& skeleton = clip_.skeleton();
  HumanClipInfo info;
  info.rate = clip_.rate();
  info.frame_count = clip_.frame_count();
  info.height = mapping_.height;
  info.size = mapping_.size;
  info.source_joints = skeleton.names();
  for (const BoneSource& source : mapping_.bones) {
    const bool known = source.position_joint >= 0 && source.rotation_joint >= 0;
    info.sources.push_back(known ? skeleton.joint(source.position_joint).name : std::string());
  }
  return info;
}

void HumanPoser::pose(int frame, std::span<Pose> world_from_bone) {
  forward_kinematics(clip_, frame, world_from_joint_);
  for (std::size_t bone = 0; bone < mapping_.bones.size(); ++bone) {
    const BoneSource& source = mapping_.bones[bone];
    if (source.position_joint < 0 || source.rotation_joint < 0) {
      world_from_bone[bone] = Pose{};
      continue;
    }
    const Pose& stand = world_from_joint_[source.position_joint];
    const Eigen::Vector3d origin =
        source.position_in_joint ? stand * *source.position_in_joint : stand.translation;
    world_from_bone[bone] = {turn_ * world_from_joint_[source.rotation_joint].rotation,
                             mapping_.human_from_source * origin * mapping_.metres_per_unit};
    if (source.joint_from_bone) {
      world_from_bone[bone].rotation = world_from_bone[bone].rotation * *source.joint_from_bone;
    }
  }
}

HumanClip to_human(const Clip& clip, const HumanMapping& mapping) {
  HumanPoser poser(clip, mapping);
  HumanClip human{poser.info(), {}};
  human.world_from_bone.resize(static_cast<std::size_t>(human.frame_count) * kBoneCount);
  const std::span<Pose> poses(human.world_from_bone);
  for (int frame = 0; frame < human.frame_count; ++frame) {
    poser.pose(frame, poses.subspan(static_cast<std::size_t>(frame) * kBoneCount, kBoneCount));
  }
  return human;
}

}  // namespace retarget
