#include <Eigen/Geometry>
#include <algorithm>

#include "human/skeleton/facing.h"

namespace retarget {
namespace {

// The knee deviates from the hip-ankle line by much less than the toe from the ankle.
constexpr double kKneeWeight = 3.0;
// Feet shorter than this share of the leg give no direction.
constexpr double kMinFootLength = 0.02;

double leg_says(const BodySource& source, const BodyPoses::Pose& pose, const BoneMap& map,
                Side side, const Eigen::Vector3d& front) {
  const Eigen::Vector3d hip = pose.joints[map.joint(side_bone(side, LimbBone::kUpLeg))];
  const Eigen::Vector3d knee = pose.joints[map.joint(side_bone(side, LimbBone::kLeg))];
  const Eigen::Vector3d ankle = pose.joints[map.joint(side_bone(side, LimbBone::kFoot))];
  const double leg = (knee - hip).norm() + (ankle - knee).norm();
  const int toe = map.joint(side_bone(side, LimbBone::kToe));
  Eigen::Vector3d tip =
      toe >= 0 ? pose.joints[toe] : pose.tips[map.joint(side_bone(side, LimbBone::kFoot))];
  if (toe >= 0 && source.poses.lengths[toe] < kMinFootLength * leg) tip = pose.tips[toe];
  return leg_facing(knee - hip, ankle - knee, tip - ankle, front);
}

// Direction from the hips to the head, or to the arms; zero if there is neither.
Eigen::Vector3d up_of_body(const BodyPoses::Pose& pose, const BoneMap& map) {
  const Eigen::Vector3d hips = pose.joints[map.joint(Bone::kHips)];
  if (map.has(Bone::kHead)) return (pose.joints[map.joint(Bone::kHead)] - hips).normalized();
  if (!map.has(Bone::kLeftArm) || !map.has(Bone::kRightArm)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d arms =
      0.5 * (pose.joints[map.joint(Bone::kLeftArm)] + pose.joints[map.joint(Bone::kRightArm)]);
  return (arms - hips).normalized();
}

}  // namespace

double leg_facing(const Eigen::Vector3d& thigh, const Eigen::Vector3d& shin,
                  const Eigen::Vector3d& foot, const Eigen::Vector3d& front) {
  const double leg = thigh.norm() + shin.norm();
  if (leg <= 0.0) return 0.0;
  // Deviation of the knee from the midpoint between hip and ankle.
  const double knee = kKneeWeight * 0.5 * (thigh - shin).dot(front) / leg;
  return foot.norm() > kMinFootLength * leg ? knee + foot.normalized().dot(front) : knee;
}

double left_is_left(const BodySource& source, const BoneMap& map) {
  for (const Bone bone : {Bone::kHips, Bone::kLeftUpLeg, Bone::kRightUpLeg, Bone::kLeftLeg,
                          Bone::kRightLeg, Bone::kLeftFoot, Bone::kRightFoot}) {
    if (!map.has(bone)) return 0.0;
  }
  double sum = 0.0;
  for (const BodyPoses::Pose& pose : source.poses.poses) {
    const Eigen::Vector3d across =
        pose.joints[map.joint(Bone::kLeftUpLeg)] - pose.joints[map.joint(Bone::kRightUpLeg)];
    const Eigen::Vector3d front = across.cross(up_of_body(pose, map)).normalized();
    for (const Side side : kSides) sum += leg_says(source, pose, map, side, front);
  }
  return std::clamp(sum / (2.0 * static_cast<double>(source.poses.poses.size())), -1.0, 1.0);
}

namespace {

std::array<std::optional<LegJoints>, 2> find_limbs(const Skeleton& skeleton,
                                                   const Calibration& calibration,
                                                   const std::array<LimbBone, 3>& parts) {
  std::array<std::optional<LegJoints>, 2> limbs;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto joint_of = [&](LimbBone part) {
      const auto& bone = calibration.bones[side_bone(kSides[side], part)];
      // Helper joints at the same position rotate with the joint.
      return is_above(skeleton, bone.position_joint, bone.rotation_joint) ? bone.position_joint
                                                                          : -1;
    };
    const LegJoints limb{joint_of(parts[0]), joint_of(parts[1]), joint_of(parts[2])};
    if (limb.hip >= 0 && limb.knee > limb.hip && limb.ankle > limb.knee &&
        is_above(skeleton, limb.hip, limb.knee) && is_above(skeleton, limb.knee, limb.ankle)) {
      limbs[side] = limb;
    }
  }
  return limbs;
}

}  // namespace

std::array<std::optional<LegJoints>, 2> find_legs(const Skeleton& skeleton,
                                                  const Calibration& calibration) {
  return find_limbs(skeleton, calibration, {LimbBone::kUpLeg, LimbBone::kLeg, LimbBone::kFoot});
}

std::array<std::optional<LegJoints>, 2> find_arms(const Skeleton& skeleton,
                                                  const Calibration& calibration) {
  return find_limbs(skeleton, calibration, {LimbBone::kArm, LimbBone::kForeArm, LimbBone::kHand});
}

}  // namespace retarget
