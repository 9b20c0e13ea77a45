#include "human/skeleton/body_poses.h"

#include <algorithm>
#include <memory>

#include "retarget/clip.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

constexpr int kMaxPoses = 48;

BodyPoses::Pose pose_of(const Clip& clip, int frame) {
  const Skeleton& skeleton = clip.skeleton();
  std::vector<Pose> world_from_joint(skeleton.joint_count());
  forward_kinematics(clip, frame, world_from_joint);
  BodyPoses::Pose pose;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const Pose& world = world_from_joint[joint];
    pose.joints.push_back(world.translation);
    pose.tips.push_back(world * farthest_end(skeleton.joint(joint)));
  }
  return pose;
}

// Uses the translations: a joint with position channels and a zero offset can still be displaced.
std::vector<double> mean_lengths(const Clip& clip, const std::vector<int>& frames) {
  const int joint_count = clip.skeleton().joint_count();
  std::vector<double> lengths(joint_count, 0.0);
  for (int joint = 1; joint < joint_count; ++joint) {
    for (const int frame : frames) lengths[joint] += clip.translation(frame, joint).norm();
    lengths[joint] /= static_cast<double>(frames.size());
  }
  return lengths;
}

// A joint without siblings above the body only positions it, so its length is not part of the body.
void forget_placing_joints(const Skeleton& skeleton, std::vector<double>& lengths) {
  std::vector<int> child_counts(skeleton.joint_count());
  for (const Joint& joint : skeleton.joints()) {
    if (joint.parent >= 0) ++child_counts[joint.parent];
  }
  for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
    if (child_counts[joint - 1] != 1 || skeleton.joint(joint).parent != joint - 1) return;
    if (!skeleton.joint(joint).has_position_channels() && joint > 1) return;
    lengths[joint] = 0.0;
  }
}

BodyPoses poses_at(const Clip& clip, const std::vector<int>& frames) {
  BodyPoses result;
  result.poses.reserve(frames.size());
  for (const int frame : frames) result.poses.push_back(pose_of(clip, frame));
  result.lengths = mean_lengths(clip, frames);
  forget_placing_joints(clip.skeleton(), result.lengths);
  return result;
}

}  // namespace

BodyPoses sample_zero_pose(const Skeleton& skeleton) {
  return poses_at(Clip(std::make_shared<const Skeleton>(skeleton), FrameRate{30, 1}, 1), {0});
}

BodyPoses sample_poses(const Clip& clip) {
  if (clip.frame_count() == 0) return sample_zero_pose(clip.skeleton());
  const int count = std::min(clip.frame_count(), kMaxPoses);
  std::vector<int> frames;
  frames.reserve(count);
  for (int i = 0; i < count; ++i) {
    frames.push_back(static_cast<int>(static_cast<long long>(clip.frame_count() - 1) * i /
                                      std::max(count - 1, 1)));
  }
  BodyPoses result = poses_at(clip, frames);
  result.from_motion = true;
  return result;
}

}  // namespace retarget
