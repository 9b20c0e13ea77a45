#include "human/posed_body.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "motion/forward_kinematics.h"

namespace retarget {
namespace {

constexpr double kSamplesPerSecond = 10.0;
constexpr int kMostSamples = 1000;

// shorter than this, relatively to nothing but rounding, a bone has no direction
constexpr double kNoLength = 1e-9;

// bones at which a bone can end, nearest first
std::vector<std::string> ends_of(std::string_view bone) {
  if (bone == "Hips") return {"Spine", "Spine1", "Spine2", "Neck", "Head"};
  if (bone == "Spine") return {"Spine1", "Spine2", "Neck", "Head"};
  if (bone == "Spine1") return {"Spine2", "Neck", "Head"};
  if (bone == "Spine2") return {"Neck", "Head"};
  if (bone == "Neck") return {"Head"};
  for (const std::string side : {"Left", "Right"}) {
    if (!bone.starts_with(side)) continue;
    const std::string_view part = bone.substr(side.size());
    if (part == "UpLeg") return {side + "Leg"};
    if (part == "Leg") return {side + "Foot"};
    if (part == "Foot") return {side + "Toe"};
    if (part == "Shoulder") return {side + "Arm"};
    if (part == "Arm") return {side + "ForeArm"};
    if (part == "ForeArm") return {side + "Hand"};
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
  for (int bone = 0; bone < kMappedBoneCount; ++bone) {
    turning_joints_[bone] = rotation_joint(map, skeleton, kBoneNames[bone]);
    segments_[bone] = find_segment(bone);
  }
}

Segment Body::find_segment(int bone) const {
  const int start = joint(bone);
  if (start < 0) return {};
  for (const std::string& end : ends_of(kBoneNames[static_cast<std::size_t>(bone)])) {
    if (has(end)) return {start, joint(end), Eigen::Vector3d::Zero()};
  }
  // what hangs from helpers in the joint's place hangs from the bone
  Segment segment = free_end(*skeleton_, std::max(turning_joint(bone), start), joint("Hips"));
  segment.joint = start;
  return segment;
}

int Body::joint(std::string_view bone) const {
  return joint(find_bone(bone).value());
}

int Body::turning_joint(std::string_view bone) const {
  return turning_joint(find_bone(bone).value());
}

const Segment& Body::segment(std::string_view bone) const {
  return segment(find_bone(bone).value());
}

std::optional<Eigen::Vector3d> along(const Segment& segment, const JointPoses& pose) {
  if (!segment.known()) return std::nullopt;
  const Eigen::Vector3d way =
      pose[segment.end_joint] * segment.offset - pose[segment.joint].translation;
  if (way.norm() < kNoLength) return std::nullopt;
  return way;
}

double length_by_offsets(const Body& body, std::string_view bone) {
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
