#include "human/skeleton/posed_body.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>

#include "human/skeleton/skeleton_tree.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

constexpr double kSamplesPerSecond = 10.0;
constexpr int kMaxSamples = 1000;

// A shorter bone has no direction. The bound only covers rounding errors.
constexpr double kNoLength = 1e-9;

// Bones at which a bone can end, nearest first; for limbs only the next one.
std::span<const Bone> ends_of(Bone bone) {
  const bool of_limb = side_of(bone) != Side::kNone;
  const auto& chain =
      of_limb ? *std::ranges::find_if(
                    bone_chains(),
                    [&](const auto& one) { return std::ranges::find(one, bone) != one.end(); })
              : trunk_bones();
  const std::span beyond(std::ranges::find(chain, bone) + 1, chain.end());
  return of_limb ? beyond.first(std::min<std::size_t>(1, beyond.size())) : beyond;
}

// End of a chain without further bones: the farthest of the joint's children and end sites.
// Children towards the hips lie on the bone's other side.
Segment free_end(const Skeleton& skeleton, int joint, int hips) {
  Segment segment{joint, joint, farthest_end(skeleton.joint(joint))};
  for (int child = joint + 1; child < skeleton.joint_count(); ++child) {
    const Joint& candidate = skeleton.joint(child);
    if (candidate.parent == joint && candidate.offset.norm() > segment.offset.norm() &&
        !is_above(skeleton, child, hips)) {
      segment.offset = candidate.offset;
    }
  }
  if (segment.offset.norm() < kNoLength) segment.end_joint = -1;
  return segment;
}

// The translation of a joint in the zero pose.
Eigen::Vector3d zero_translation(const Clip& clip, int joint) {
  constexpr double kConstant = 0.01, kContradicts = 0.02;  // Shares of its length.
  const Joint& of = clip.skeleton().joint(joint);
  if (of.parent < 0 || !of.has_position_channels() || clip.frame_count() == 0) return of.offset;
  const Eigen::Vector3d& first = clip.translation(0, joint);
  if ((first - of.offset).norm() <= kContradicts * std::max(first.norm(), of.offset.norm())) {
    return of.offset;
  }
  for (int frame = 1; frame < clip.frame_count(); ++frame) {
    if ((clip.translation(frame, joint) - first).norm() > kConstant * first.norm()) {
      return of.offset;
    }
  }
  return first;
}

// Sums the translations of joints from the root down.
template <typename Translation>
JointPoses unrotated_pose(const Skeleton& skeleton, const Translation& translation) {
  JointPoses poses(skeleton.joint_count());
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    const int parent = skeleton.joint(joint).parent;
    poses[joint].translation = translation(joint);
    if (parent >= 0) poses[joint].translation += poses[parent].translation;
  }
  return poses;
}

}  // namespace

JointPoses zero_pose(const Skeleton& skeleton) {
  return unrotated_pose(skeleton, [&](int joint) { return skeleton.joint(joint).offset; });
}

JointPoses zero_pose(const Clip& clip) {
  return unrotated_pose(clip.skeleton(), [&](int joint) { return zero_translation(clip, joint); });
}

JointPoses frame_pose(const Clip& clip, int frame) {
  JointPoses poses(clip.skeleton().joint_count());
  forward_kinematics(clip, frame, poses);
  return poses;
}

std::vector<int> sampled_frames(const Clip& clip, int begin) {
  int stride = std::max(1, static_cast<int>(std::lround(clip.rate().fps() / kSamplesPerSecond)));
  while (clip.frame_count() / stride > kMaxSamples) stride *= 2;
  std::vector<int> frames;
  for (int frame = begin; frame < clip.frame_count(); frame += stride) frames.push_back(frame);
  return frames;
}

std::vector<int> joints_in_place(const Clip& clip) {
  constexpr double kNoise = 3e-3;
  std::vector<int> joints;
  if (clip.frame_count() == 0) return joints;
  std::vector<double> lengths;
  for (int joint = 1; joint < clip.skeleton().joint_count(); ++joint) {
    const double length = clip.translation(0, joint).norm();
    if (length > 0.0) lengths.push_back(length);
  }
  if (lengths.empty()) return joints;
  const double most = kNoise * median_in_place(lengths);
  for (int joint = 1; joint < clip.skeleton().joint_count(); ++joint) {
    if (!clip.skeleton().joint(joint).has_position_channels()) continue;
    int frame = 0;
    while (frame < clip.frame_count() && clip.translation(frame, joint).norm() <= most) ++frame;
    if (frame == clip.frame_count()) joints.push_back(joint);
  }
  return joints;
}

int first_in_place(const Skeleton& skeleton, const BoneMap& map, int joint) {
  const auto is_helper = [&](int other) { return other > 0 && !map.maps(other); };
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

std::vector<int> Body::joints_of(LimbBone part) const {
  std::vector<int> found;
  for (const Side side : kSides) {
    const Bone bone = side_bone(side, part);
    if (has(bone)) found.push_back(joint(bone));
  }
  return found;
}

Segment Body::find_segment(Bone bone) const {
  const int start = joint(bone);
  if (start < 0) return {};
  for (const Bone end : ends_of(bone)) {
    if (has(end)) return {start, joint(end), Eigen::Vector3d::Zero()};
  }
  // Children of helpers at the joint's position belong to the bone.
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

Eigen::Matrix3d minimal_rotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                 const Eigen::Vector3d& fallback) {
  // 2.6 degrees from opposite. Up to there, the formula below is accurate to 1e-13.
  constexpr double kNearlyOpposite = -0.999;
  const double cosine = a.dot(b);
  // A half turn about a unit axis u is 2 u u^T - 1.
  const auto half_turn = [](const Eigen::Vector3d& u) -> Eigen::Matrix3d {
    return 2.0 * u * u.transpose() - Eigen::Matrix3d::Identity();
  };
  if (cosine < -1.0 + 1e-12) return minimal_rotation(-a, b, fallback) * half_turn(fallback);
  // A half turn about a, then one about the bisector. Only the difference of the directions
  // cancels.
  if (cosine < kNearlyOpposite) {
    // Lengths that are inexact by rounding would tilt the short sum along the difference.
    const Eigen::Vector3d across = (a - b).normalized();
    const Eigen::Vector3d sum = a + b;
    return half_turn((sum - across.dot(sum) * across).normalized()) * half_turn(a);
  }
  // Rodrigues' formula with the sine in the axis: 1 + [v] + [v]^2 / (1 + cosine).
  const Eigen::Matrix3d cross = skew(a.cross(b));
  return Eigen::Matrix3d::Identity() + cross + cross * cross / (1.0 + cosine);
}

std::optional<BodyFromFile> body_axes(const Body& body, const JointPoses& pose,
                                      const Eigen::Vector3d& up) {
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  for (const LimbBone part : {LimbBone::kUpLeg, LimbBone::kArm}) {
    const int l = body.joint(side_bone(Side::kLeft, part));
    const int r = body.joint(side_bone(Side::kRight, part));
    if (l >= 0 && r >= 0) left += pose[l].translation - pose[r].translation;
  }
  const double length = left.norm();
  left -= left.dot(up) * up;
  // The negated comparison rejects NaN too.
  if (!(left.norm() > 0.2 * length)) return std::nullopt;
  return given_axes(left.normalized().cross(up), up);
}

BodyFromFile given_axes(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
  const Eigen::Vector3d ahead = (forward - forward.dot(up) * up).normalized();
  BodyFromFile axes;
  axes << ahead.transpose(), up.cross(ahead).transpose(), up.transpose();
  return axes;
}

SignedAxis nearest_axis(const Eigen::Vector3d& direction) {
  SignedAxis nearest;
  direction.cwiseAbs().maxCoeff(&nearest.axis);
  nearest.negative = direction[nearest.axis] < 0.0;
  return nearest;
}

std::optional<Eigen::Vector3d> trunk_direction(const Body& body, const JointPoses& pose) {
  for (const Bone bone : {Bone::kHead, Bone::kNeck, Bone::kSpine2, Bone::kSpine1, Bone::kSpine}) {
    if (!body.has(bone)) continue;
    const Eigen::Vector3d way =
        pose[body.joint(bone)].translation - pose[body.joint(Bone::kHips)].translation;
    if (way.norm() > 0.0) return way.normalized();
  }
  return std::nullopt;
}

Eigen::Matrix3d z_up_from_file(const SignedAxis& up) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();  // Rows: x, y, z.
  axes(0, up.axis == 0 ? 1 : 0) = 1.0;
  axes(2, up.axis) = up.negative ? -1.0 : 1.0;
  axes.row(1) = axes.row(2).cross(axes.row(0));
  return axes;
}

Eigen::Matrix3d z_up_from_file(const Eigen::Vector3d& up) {
  const SignedAxis nearest = nearest_axis(up);
  const Eigen::Matrix3d axes = z_up_from_file(nearest);
  if (up == nearest.direction()) return axes;
  return rotation_between(axes * up, Eigen::Vector3d::UnitZ()).toRotationMatrix() * axes;
}

double tilt_degrees(const Calibration& calibration) {
  const Eigen::Vector3d up = calibration.human_from_source.row(2);
  return angle_between(up, calibration.up.direction()) * 180.0 / std::numbers::pi;
}

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
