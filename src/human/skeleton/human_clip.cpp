#include "human/skeleton/calibrate.h"

#include <cstddef>
#include <limits>
#include <utility>

#include "human/skeleton/joint_clip.h"
#include "human/skeleton/robot_human.h"
#include "retarget/clip_arrays.h"
#include "retarget/human_poser.h"

namespace retarget {

Calibration lafan1_calibration(const BoneArray<int>& joints, const BoneArray<int>& turning) {
  Calibration calibration;
  calibration.profile = "lafan1";
  for (const Bone bone : kMappedBones) calibration.bones[bone] = {joints[bone], turning[bone]};
  for (const Side side : kSides) {
    const int foot = joints[side_bone(side, LimbBone::kFoot)];
    const int toe = turning[side_bone(side, LimbBone::kToe)];
    if (foot >= 0 && toe >= 0) calibration.bones[side_bone(side, LimbBone::kFootMod)] = {foot, toe};
  }
  calibration.metres_per_unit = 0.01;
  // A quarter turn about x maps y (up) to z.
  calibration.human_from_source << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  calibration.height = 1.75;
  calibration.description =
      "LAFAN1 skeleton, centimetres, Y up, body height 1.75 m as in the published method";
  return calibration;
}

HumanPoser::HumanPoser(const Clip& clip, const Calibration& calibration)
    : clip_(clip),
      calibration_(calibration),
      turn_(calibration.human_from_source),
      world_from_joint_(clip.skeleton().joint_count()) {}

HumanClipInfo HumanPoser::info() const {
  const Skeleton& skeleton = clip_.skeleton();
  HumanClipInfo info;
  info.rate = clip_.rate();
  info.frame_count = clip_.frame_count();
  info.height = calibration_.height;
  info.size = calibration_.size;
  info.soles = calibration_.soles;
  info.built = calibration_.built;
  info.standing_bend = calibration_.standing_bend;
  info.source_joints = skeleton.names();
  for (const Bone bone : kAllBones) {
    const BoneSource& source = calibration_.bones[bone];
    if (source.position_joint < 0 || source.rotation_joint < 0) continue;
    info.sources[bone] = skeleton.joint(source.position_joint).name;
  }
  return info;
}

void HumanPoser::pose(int frame, HumanPose& world_from_bone) {
  forward_kinematics(clip_, frame, world_from_joint_);
  for (const Bone bone : kAllBones) {
    const BoneSource& source = calibration_.bones[bone];
    if (source.position_joint < 0 || source.rotation_joint < 0) {
      world_from_bone[bone] = Pose{};
      continue;
    }
    const Pose& stand = world_from_joint_[source.position_joint];
    const Eigen::Vector3d origin =
        source.position_in_joint ? stand * *source.position_in_joint : stand.translation;
    const bool is_twisted = source.twist_joint >= 0;
    const int turning = is_twisted ? source.twist_joint : source.rotation_joint;
    world_from_bone[bone] = {
        turn_ * world_from_joint_[turning].rotation,
        calibration_.human_from_source * origin * calibration_.metres_per_unit};
    if (is_twisted) {
      world_from_bone[bone].rotation = world_from_bone[bone].rotation * source.twist_from_bone;
    } else if (source.joint_from_bone) {
      world_from_bone[bone].rotation = world_from_bone[bone].rotation * *source.joint_from_bone;
    }
  }
}

HumanPoseSource poses_of(const HumanClip& human) {
  return [&human](int frame, HumanPose& world_from_bone) { world_from_bone = human.frame(frame); };
}

HumanPoseSource poses_of(HumanPoser& poser) {
  return [&poser](int frame, HumanPose& world_from_bone) { poser.pose(frame, world_from_bone); };
}

HumanClip to_human(const Clip& clip, const Calibration& calibration) {
  HumanPoser poser(clip, calibration);
  HumanClip human{poser.info(), {}};
  human.world_from_bone.resize(human.frame_count);
  for (int frame = 0; frame < human.frame_count; ++frame) {
    poser.pose(frame, human.world_from_bone[frame]);
  }
  return human;
}

Result<Clip> clip_of_human(const Clip& clip, const Calibration& calibration) {
  if (clip.frame_count() == 0) return input_failure(clip.name(), "the clip has no frames");
  HumanPoser poser(clip, calibration);
  const HumanClipInfo info = poser.info();
  // Reuse the conversion from a robot's motion to a human clip.
  RobotHuman human;
  human.rate = clip.rate();
  human.frame_count = clip.frame_count();
  human.poses = poses_of(poser);
  for (const Bone bone : kMappedBones) human.has[bone] = info.has(bone);
  poser.pose(0, human.standing);
  Clip bones = clip_of_robot_human(human, clip.name());
  ClipOrigin origin = bones.origin();
  origin.body_height = calibration.height;
  bones.set_origin(std::move(origin));
  return bones;
}

Result<Clip> clip_from_positions(const JointPositions& given) {
  constexpr std::size_t kMax = std::numeric_limits<int>::max();
  if (given.frames == 0 || given.joints == 0 || given.frames > kMax || given.joints > kMax) {
    return usage_failure("positions: expected frames and joints, found none or too many");
  }
  JointMotion motion;
  motion.rate = given.rate;
  motion.names = given.names;
  motion.frame_count = static_cast<int>(given.frames);
  motion.joint_count = static_cast<int>(given.joints);
  motion.positions.reserve(given.positions.size() / 3);
  for (std::size_t i = 0; i + 2 < given.positions.size(); i += 3) {
    motion.positions.emplace_back(given.positions[i], given.positions[i + 1],
                                  given.positions[i + 2]);
  }
  return clip_of_joints(motion, given.name);
}

}  // namespace retarget
