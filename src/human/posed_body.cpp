#include "human/posed_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "motion/forward_kinematics.h"

namespace retarget {
namespace {

constexpr double kSamplesPerSecond = 10.0;
constexpr int kMostSamples = 1000;

// shorter than this, relatively to nothing but rounding, a bone has no direction
constexpr double kNoLength = 1e-9;

// bones at which a bone can end, nearest first
std::span<const Bone> ends_of(Bone bone) {
  static constexpr std::array kTrunk = {Bone::kHips,   Bone::kSpine, Bone::kSpine1,
                                        Bone::kSpine2, Bone::kNeck,  Bone::kHead};
  static constexpr std::array kLimbs = {
      std::array{Bone::kLeftUpLeg, Bone::kLeftLeg, Bone::kLeftFoot, Bone::kLeftToe},
      std::array{Bone::kRightUpLeg, Bone::kRightLeg, Bone::kRightFoot, Bone::kRightToe},
      std::array{Bone::kLeftShoulder, Bone::kLeftArm, Bone::kLeftForeArm, Bone::kLeftHand},
      std::array{Bone::kRightShoulder, Bone::kRightArm, Bone::kRightForeArm, Bone::kRightHand}};
  const auto in_trunk = std::ranges::find(kTrunk, bone);
  if (in_trunk != kTrunk.end()) return {in_trunk + 1, kTrunk.end()};
  for (const auto& limb : kLimbs) {
    const auto found = std::ranges::find(limb, bone);
    if (found == limb.end()) continue;
    const std::span beyond(found + 1, limb.end());
    return beyond.first(std::min<std::size_t>(1, beyond.size()));
  }
  return {};
}

// where a chain ends without further bones: the farthest of the joint's children and end sites;
// children on the way to the hips lie on the bone's other side
Segment free_end(const Skeleton& skeleton, int joint, int hips) {
  Segment segment{joint, joint, Eigen::Vector3d::Zero()};
  const auto leads_to_hips = [&](const Joint& child) {
    for (int at = hips; at >= 0; at = skeleton.joint(at).parent) {
      if (&skeleton.joint(at) == &child) return true;
    }
    return false;
  };
  for (const Eigen::Vector3d& site : skeleton.joint(joint).end_sites) {
    if (site.norm() > segment.offset.norm()) segment.offset = site;
  }
  for (const Joint& child : skeleton.joints()) {
    if (child.parent == joint && child.offset.norm() > segment.offset.norm() &&
        !leads_to_hips(child)) {
      segment.offset = child.offset;
    }
  }
  if (segment.offset.norm() < kNoLength) segment.end_joint = -1;
  return segment;
}

}  // namespace

JointPoses zero_pose(const Skeleton& skeleton) {
  JointPoses poses(static_cast<std::size_t>(skeleton.joint_count()));
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const int parent = skeleton.joint(joint).parent;
    poses[joint].translation = skeleton.joint(joint).offset;
    if (parent >= 0) poses[joint].translation += poses[parent].translation;
  }
  return poses;
}

JointPoses frame_pose(const Clip& clip, int frame) {
  JointPoses poses(static_cast<std::size_t>(clip.skeleton().joint_count()));
  forward_kinematics(clip, frame, poses);
  return poses;
}

std::vector<int> sampled_frames(const Clip& clip, int begin) {
  int stride = std::max(1, static_cast<int>(std::lround(clip.rate().fps() / kSamplesPerSecond)));
  while (clip.frame_count() / stride > kMostSamples) stride *= 2;
  std::vector<int> frames;
  for (int frame = begin; frame < clip.frame_count(); frame += stride) frames.push_back(frame);
  return frames;
}

int first_in_place(const Skeleton& skeleton, const BoneMap& map, int joint) {
  const auto is_helper = [&](int other) {
    return other > 0 && std::ranges::find(map.joint_of_bone, other) == map.joint_of_bone.end();
  };
  while (joint > 0 && skeleton.joint(joint).offset.isZero(0.0) &&
         is_helper(skeleton.joint(joint).parent)) {
    joint = skeleton.joint(joint).parent;
  }
  return joint;
}

Body::Body(const Skeleton& skeleton, const BoneMap& map)
    : skeleton_(&skeleton), joints_(map.joint_of_bone) {
  for (const Bone bone : kAllBones) {
    turning_joints_[bone] = rotation_joint(map, skeleton, bone);
    segments_[bone] = find_segment(bone);
  }
}

Segment Body::find_segment(Bone bone) const {
  const int start = joint(bone);
  if (start < 0) return {};
  for (const Bone end : ends_of(bone)) {
    if (has(end)) return {start, joint(end), Eigen::Vector3d::Zero()};
  }
  // what hangs from helpers in the joint's place hangs from the bone
  Segment segment = free_end(*skeleton_, std::max(turning_joint(bone), start), joint(Bone::kHips));
  segment.joint = start;
  return segment;
}

std::optional<Eigen::Vector3d> along(const Segment& segment, const JointPoses& pose) {
  if (!segment.known()) return std::nullopt;
  const Eigen::Vector3d way =
      pose[segment.end_joint] * segment.offset - pose[segment.joint].translation;
  if (way.norm() < kNoLength) return std::nullopt;
  return way;
}

double length_by_offsets(const Body& body, Bone bone) {
  const Segment& segment = body.segment(bone);
  if (!segment.known()) return 0.0;
  double length = segment.offset.norm();
  for (int joint = segment.end_joint; joint > segment.joint;
       joint = body.skeleton().joint(joint).parent) {
    length += body.skeleton().joint(joint).offset.norm();
  }
  return length;
}

Eigen::Matrix3d least_rotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                               const Eigen::Vector3d& fallback) {
  const double cosine = a.dot(b);
  if (cosine < -1.0 + 1e-12) {
    // half a turn about an axis u is 2 u u^T - 1
    return 2.0 * fallback * fallback.transpose() - Eigen::Matrix3d::Identity();
  }
  // Rodrigues' formula with the sine in the axis: 1 + [v] + [v]^2 / (1 + cosine)
  const Eigen::Vector3d v = a.cross(b);
  Eigen::Matrix3d cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return Eigen::Matrix3d::Identity() + cross + cross * cross / (1.0 + cosine);
}

}  // namespace retarget
