#include "human/skeleton/twist_joints.h"

#include <algorithm>

#include "human/skeleton/limb_segments.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// A share of the segment's length. Joints that are nearer to the far end belong to the next bone.
constexpr double kAtTheEnd = 0.05;
// Largest distance from the line of the segment, as a share of its length.
constexpr double kOffTheLine = 0.1;
// Largest sine of the angle between the segment and its part beyond the joint.
constexpr double kBent = 0.2;

// The joints above `end`, up to but without `start`, from the last one; empty if `end` is not below
// `start`.
std::vector<int> joints_inside(const Skeleton& skeleton, int start, int end) {
  std::vector<int> inside;
  int joint = skeleton.joint(end).parent;
  for (; joint > start; joint = skeleton.joint(joint).parent) inside.push_back(joint);
  if (joint != start) inside.clear();
  return inside;
}

// Whether a joint stays near the straight line between two others and does not bend it.
bool stays_on_line(int joint, int start, int end, const JointPoses& pose) {
  const Vector3d along = pose[end].translation - pose[start].translation;
  const Vector3d way = pose[joint].translation - pose[start].translation;
  const Vector3d rest = along - way;
  const double length = along.norm();
  return length > 0.0 && along.cross(way).norm() <= kOffTheLine * length * length &&
         along.cross(rest).norm() <= kBent * length * rest.norm() && along.dot(rest) >= 0.0;
}

// The last joint inside a bone that twists it; -1: none.
int find_twist_joint(const Skeleton& skeleton, int start, int end,
                     const std::vector<JointPoses>& poses) {
  std::vector<int> inside = joints_inside(skeleton, start, end);
  const auto distance = [&](int from) {
    return (poses.front()[end].translation - poses.front()[from].translation).norm();
  };
  std::erase_if(inside, [&](int joint) { return distance(joint) < kAtTheEnd * distance(start); });
  const bool is_straight = std::ranges::all_of(inside, [&](int joint) {
    return std::ranges::all_of(
        poses, [&](const JointPoses& pose) { return stays_on_line(joint, start, end, pose); });
  });
  return inside.empty() || !is_straight ? -1 : inside.front();
}

}  // namespace

BoneArray<int> find_twist_joints(const Body& body, const std::vector<JointPoses>& poses) {
  BoneArray<int> found(-1);
  if (poses.empty()) return found;
  for (const Side side : kSides) {
    for (const auto& [from, to] : kLimbParts) {
      const Bone bone = side_bone(side, from);
      const int start = body.turning_joint(bone), end = body.joint(side_bone(side, to));
      if (start >= 0 && end >= 0) {
        found[bone] = find_twist_joint(body.skeleton(), start, end, poses);
      }
    }
  }
  return found;
}

void split_twists(const BoneArray<int>& twist_joints, const BoneArray<int>& starts,
                  const JointPoses& rest, BoneArray<BoneSource>& bones) {
  for (const Bone bone : kMappedBones) {
    const int twist = twist_joints[bone], start = starts[bone];
    BoneSource& source = bones[bone];
    if (twist < 0 || source.rotation_joint != twist) continue;
    source.rotation_joint = start;
    source.twist_joint = twist;
    if (!source.joint_from_bone) continue;
    source.twist_from_bone = *source.joint_from_bone;
    source.joint_from_bone =
        (rest[start].rotation.conjugate() * rest[twist].rotation * source.twist_from_bone)
            .normalized();
  }
}

}  // namespace retarget
