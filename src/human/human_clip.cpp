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

// the joint that has a bone's name
int find_joint(const Skeleton& skeleton, Bone bone) {
  if (const auto joint = skeleton.find(bone_name(bone))) return *joint;
  const bool is_toe = limb_bone(bone) == LimbBone::kToe;
  return is_toe ? skeleton.find(std::string(bone_name(bone)) + "Base").value_or(-1) : -1;
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
  for (const Bone bone :
       {Bone::kLeftLeg, Bone::kLeftFoot, Bone::kRightLeg, Bone::kRightFoot, Bone::kLeftForeArm,
        Bone::kLeftHand, Bone::kRightForeArm, Bone::kRightHand}) {
    const std::optional<int> joint = joint_of(bone);
    if (joint && !runs_along(skeleton.joint(*joint).offset, 0)) {
      off_axis.emplace_back(bone_name(bone));
    }
  }
  for (const Bone bone : {Bone::kLeftUpLeg, Bone::kLeftShoulder}) {
    const std::optional<int> left = joint_of(bone), right = joint_of(mirrored(bone));
    if (!left || !right) continue;
    const Eigen::Vector3d across = skeleton.joint(*left).offset - skeleton.joint(*right).offset;
    if (!runs_along(across, 2)) {
      off_axis.push_back("Left/" + std::string(bone_name(mirrored(bone))));
    }
  }
  return off_axis;
}

double lafan1_leg_length(const Skeleton& skeleton, const JointOfBone& joint_of) {
  const std::optional<int> knee = joint_of(Bone::kLeftLeg), ankle = joint_of(Bone::kLeftFoot);
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
  const JointOfBone by_name = [&](Bone bone) { return skeleton.find(bone_name(bone)); };
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

// the published method's, for the joints of the bones; the synthetic feet stand at the ankles and
// turn with the toes
HumanMapping published_mapping(const BoneArray<int>& joints) {
  HumanMapping mapping;
  mapping.dialect = "lafan1";
  for (const Bone bone : kMappedBones) mapping.bones[bone] = {joints[bone], joints[bone]};
  for (const Side side : kSides) {
    const int foot = joints[side_bone(side, LimbBone::kFoot)];
    const int toe = joints[side_bone(side, LimbBone::kToe)];
    if (foot >= 0 && toe >= 0) mapping.bones[side_bone(side, LimbBone::kFootMod)] = {foot, toe};
  }
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
  for (const std::string& bone : bone_names()) {
    if (std::ranges::count(skeleton.joints(), bone, &Joint::name) > 1) {
      return input_failure(
          file,
          "several joints are called \"" + bone + "\": which of them is the bone cannot be told",
          "rename all but one of them");
    }
  }
  BoneArray<int> joints(-1);
  for (const Bone bone : kMappedBones) joints[bone] = find_joint(skeleton, bone);
  HumanMapping mapping = published_mapping(joints);
  mapping.doubts = lafan1_doubts(skeleton);
  return mapping;
}

HumanMapping lafan1_mapping(const BoneMap& map) {
  return published_mapping(map.joint_of_bone);
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
  for (const Bone bone : kAllBones) {
    const BoneSource& source = mapping_.bones[bone];
    if (source.position_joint < 0 || source.rotation_joint < 0) continue;
    info.sources[bone] = skeleton.joint(source.position_joint).name;
  }
  return info;
}

void HumanPoser::pose(int frame, HumanPose& world_from_bone) {
  forward_kinematics(clip_, frame, world_from_joint_);
  for (const Bone bone : kAllBones) {
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

HumanPoseSource poses_of(const HumanClip& human) {
  return [&human](int frame, HumanPose& world_from_bone) { world_from_bone = human.frame(frame); };
}

HumanClip to_human(const Clip& clip, const HumanMapping& mapping) {
  HumanPoser poser(clip, mapping);
  HumanClip human{poser.info(), {}};
  human.world_from_bone.resize(static_cast<std::size_t>(human.frame_count));
  for (int frame = 0; frame < human.frame_count; ++frame) {
    poser.pose(frame, human.world_from_bone[static_cast<std::size_t>(frame)]);
  }
  return human;
}

}  // namespace retarget
