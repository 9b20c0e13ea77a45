#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <utility>

#include "human/skeleton/calibrate.h"
#include "human/skeleton/calibration_text.h"
#include "human/skeleton/posed_body.h"
#include "human/skeleton/robot_human.h"
#include "human/skeleton/skeleton_tree.h"
#include "human/skeleton/stated_axes.h"
#include "human/skeleton/up_axis.h"
#include "human/skeleton/up_evidence.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

using enum LimbBone;

// Thigh and shin per height, for a body of which only the legs are known (docs/human.md).
constexpr double kLegsPerHeight = 0.491;

// Bone that carries another one; the hips are the last resort.
Bone carrier_of(Bone bone) {
  for (const std::vector<Bone>& chain : bone_chains()) {
    const auto at = std::ranges::find(chain, bone);
    if (at != chain.begin() && at != chain.end()) return *(at - 1);
  }
  return Bone::kHips;
}

// Position channels precede rotation channels.
constexpr std::array kChannels = {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition,
                                  Channel::kZRotation, Channel::kYRotation, Channel::kXRotation};

// Joint frames have world axes in the T-pose.
Pose world_from_joint(const HumanPose& pose, Bone bone) {
  const Eigen::Quaterniond t_pose(canonical_t_pose(bone));
  return {(pose[bone].rotation * t_pose.conjugate()).normalized(), pose[bone].translation};
}

class ClipMaker {
 public:
  explicit ClipMaker(const RobotHuman& human) : human_(human) {
    for (const Bone bone : kMappedBones) {
      if (!human.has[bone]) continue;
      joint_of_bone_[bone] = static_cast<int>(bones_.size());
      bones_.push_back(bone);
    }
    constexpr double kStill = 1e-9;  // Metres.
    HumanPose pose;
    for (int frame = 0; frame < human.frame_count; ++frame) {
      human.poses(frame, pose);
      for (const Bone bone : bones_) {
        const Eigen::Vector3d away = place(pose, bone) - place(human.standing, bone);
        moves_[bone] = moves_[bone] || !(away.cwiseAbs().maxCoeff() <= kStill);
      }
    }
  }

  [[nodiscard]] Clip make(const std::string& name) const {
    auto skeleton = std::make_shared<const Skeleton>(joints());
    Clip clip(skeleton, human_.rate, human_.frame_count);
    HumanPose pose;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      human_.poses(frame, pose);
      for (std::size_t joint = 0; joint < bones_.size(); ++joint) {
        const Pose local = parent_from_joint(pose, bones_[joint]);
        clip.rotations(frame)[joint] = local.rotation;
        const int slot = skeleton->translation_slot(static_cast<int>(joint));
        if (slot >= 0) clip.translations(frame)[static_cast<std::size_t>(slot)] = local.translation;
      }
    }
    make_sign_continuous(clip);
    ClipOrigin origin;
    origin.name = name;
    origin.metres_per_unit = 1.0;
    origin.up = Eigen::Vector3d::UnitZ();
    origin.robot = human_.robot;
    clip.set_origin(std::move(origin));
    return clip;
  }

 private:
  // The nearest carrier that the body has; nothing for the hips.
  [[nodiscard]] std::optional<Bone> parent_of(Bone bone) const {
    if (bone == Bone::kHips) return std::nullopt;
    Bone carrier = carrier_of(bone);
    while (!human_.has[carrier] && carrier != Bone::kHips) carrier = carrier_of(carrier);
    return carrier;
  }

  [[nodiscard]] Pose parent_from_joint(const HumanPose& pose, Bone bone) const {
    const std::optional<Bone> parent = parent_of(bone);
    const Pose world = world_from_joint(pose, bone);
    return parent ? world_from_joint(pose, *parent).inverse() * world : world;
  }

  // Position in the parent joint.
  [[nodiscard]] Eigen::Vector3d place(const HumanPose& pose, Bone bone) const {
    return parent_from_joint(pose, bone).translation;
  }

  [[nodiscard]] std::vector<Joint> joints() const {
    std::vector<Joint> joints;
    for (const Bone bone : bones_) {
      Joint joint;
      joint.name = bone_name(bone);
      const std::optional<Bone> parent = parent_of(bone);
      const bool turns_only = parent && !moves_[bone];
      joint.channels.assign(kChannels.begin() + (turns_only ? 3 : 0), kChannels.end());
      if (parent) {
        joint.parent = joint_of_bone_[*parent];
        joint.offset = place(human_.standing, bone);
      }
      add_sole(bone, joint);
      joints.push_back(std::move(joint));
    }
    return joints;
  }

  // In the T-pose, feet and toes stand flat on the floor, so they share their axes.
  void add_sole(Bone bone, Joint& joint) const {
    const std::optional<LimbBone> part = limb_bone(bone);
    if (part != kFoot && part != kToe) return;
    const auto& sole = human_.soles[side_of(bone) == Side::kLeft ? 0 : 1];
    if (!sole) return;
    const Eigen::Matrix3d axes = canonical_t_pose(side_bone(side_of(bone), kFootMod));
    if (part == kToe) {
      joint.end_sites = {axes * (sole->toe.tip - sole->toe.middle)};
    } else {
      joint.end_sites = {axes * sole->heel.middle, axes * sole->heel.tip};
    }
  }

  const RobotHuman& human_;
  std::vector<Bone> bones_;  // One per joint.
  BoneArray<int> joint_of_bone_{-1};
  BoneArray<bool> moves_{false};  // Whether a bone moves relative to its parent.
};

std::optional<FootSole> sole_of(const Skeleton& skeleton, const BoneMap& map, Side side) {
  const int foot = map.joint(side_bone(side, kFoot)), toe = map.joint(side_bone(side, kToe));
  if (foot < 0 || toe < 0) return std::nullopt;
  const std::vector<Eigen::Vector3d>& heel = skeleton.joint(foot).end_sites;
  const std::vector<Eigen::Vector3d>& tip = skeleton.joint(toe).end_sites;
  if (heel.size() != 2 || tip.size() != 1) return std::nullopt;
  const Eigen::Matrix3d to_foot = canonical_t_pose(side_bone(side, kFootMod)).transpose();
  const Eigen::Vector3d& middle = skeleton.joint(toe).offset;
  return FootSole{{to_foot * heel[0], to_foot * heel[1]},
                  {to_foot * middle, to_foot * (middle + tip[0])}};
}

BodyLengths lengths_of(const Skeleton& skeleton, const BoneMap& map) {
  const auto offset = [&](Bone bone) -> Eigen::Vector3d {
    const int joint = map.joint(bone);
    return joint < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : skeleton.joint(joint).offset;
  };
  BodyLengths lengths;
  for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2}) {
    lengths.trunk += offset(bone);
  }
  for (const Side side : kSides) {
    const auto of = [&](LimbBone part) { return offset(side_bone(side, part)); };
    lengths.leg += 0.5 * (of(kLeg).norm() + of(kFoot).norm());
    lengths.upper_arm += 0.5 * of(kForeArm).norm();
    lengths.forearm += 0.5 * of(kHand).norm();
    const Eigen::Vector3d shoulder = of(kShoulder) + of(kArm);
    lengths.trunk += 0.5 * (shoulder - of(kUpLeg));
    lengths.shoulders += side == Side::kLeft ? shoulder : Eigen::Vector3d(-shoulder);
  }
  return lengths;
}

}  // namespace

Clip clip_of_robot_human(const RobotHuman& human, const std::string& name) {
  return ClipMaker(human).make(name);
}

bool is_of_robot(const Clip& clip) {
  return !clip.origin().robot.empty();
}

BoneMap bone_map_of_robot(const Clip& clip) {
  BoneMap map;
  map.profile = "robot";
  map.confidence = 1.0;
  for (const Bone bone : kMappedBones) {
    map.joint_of_bone[bone] = clip.skeleton().find(bone_name(bone)).value_or(-1);
  }
  return map;
}

Calibration calibration_of_robot(const Clip& clip, const BoneMap& map) {
  const Skeleton& skeleton = clip.skeleton();
  Calibration calibration;
  calibration.profile = "robot";
  const auto axes = [](Bone bone) { return Eigen::Quaterniond(canonical_t_pose(bone)); };
  for (const Bone bone : kMappedBones) {
    if (map.has(bone)) {
      calibration.bones[bone] = {map.joint(bone), map.joint(bone), axes(bone), std::nullopt};
    }
  }
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    const Side side = kSides[i];
    const int foot = map.joint(side_bone(side, kFoot)), toe = map.joint(side_bone(side, kToe));
    const Bone foot_mod = side_bone(side, kFootMod);
    if (foot >= 0 && toe >= 0)
      calibration.bones[foot_mod] = {foot, toe, axes(foot_mod), std::nullopt};
    calibration.soles[i] = sole_of(skeleton, map, side);
  }
  calibration.metres_per_unit = 1.0;
  calibration.human_from_source = Eigen::Matrix3d::Identity();
  calibration.built = lengths_of(skeleton, map);
  const double legs = calibration.built->leg;
  if (legs > 0.0) calibration.height = calibration.size = legs / kLegsPerHeight;
  calibration.unit = "m";
  calibration.up = {2, false};
  calibration.forward = {0, false};
  calibration.rest_pose = "zero pose";
  calibration.description = fmt::format(
      "the robot {} as a human: bones, joints and soles from its model, leg length {:.2f} m",
      clip.origin().robot, legs);
  return calibration;
}

void settle_robot_up(const Clip& clip, const BoneMap& map,
                     const std::optional<Eigen::Vector3d>& told, Calibration& calibration) {
  const Body body(clip.skeleton(), map);
  std::vector<JointPoses> poses;
  for (const int frame : sampled_frames(clip)) poses.push_back(frame_pose(clip, frame));
  KnownUp known;
  known.of_file = SignedAxis{2, false};
  known.of_fall = free_fall_axis(clip, body, 0);
  UpChoice choice = choose_up(body, poses, known);
  calibration.up = told ? nearest_axis(*told) : choice.axis;
  if (told) choice.doubt = doubt_stated_up(body, poses, *told, choice);
  calibration.up_is_uncertain = !choice.doubt.empty();
  if (calibration.up_is_uncertain) calibration.doubts.push_back({0, 0, std::move(choice.doubt)});
  const Eigen::Vector3d up = told.value_or(calibration.up.direction());
  if (up == Eigen::Vector3d::UnitZ()) return;
  calibration.human_from_source = z_up_from_file(up);
  calibration.description += ", " + up_text(calibration) + " up";
}

}  // namespace retarget
