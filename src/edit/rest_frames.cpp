#include "edit/rest_frames.h"

#include <Eigen/SVD>
#include <algorithm>

#include "retarget/human_skeleton.h"
#include "retarget/skeleton_points.h"
#include "retarget/so3.h"

namespace retarget {
namespace {

// Joint positions in the T-pose relative to the root, z up, file units.
class TPose {
 public:
  TPose(const Skeleton& skeleton, const Calibration& calibration)
      : skeleton_(skeleton),
        calibration_(calibration),
        turns_(t_pose_rotations(skeleton, calibration)) {
    for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
      const int parent = skeleton.joint(joint).parent;
      Eigen::Vector3d place = Eigen::Vector3d::Zero();
      if (parent >= 0) place = places_[parent] + turns_[parent] * skeleton.joint(joint).offset;
      places_.push_back(place);
    }
  }

  [[nodiscard]] Eigen::Vector3d place_of(const BoneSource& bone) const {
    const Eigen::Vector3d& place = places_[bone.position_joint];
    if (!bone.position_in_joint) return place;
    return place + turns_[bone.position_joint] * *bone.position_in_joint;
  }

  [[nodiscard]] std::optional<double> lowest_of_feet() const {
    std::optional<double> lowest;
    for (const Bone foot : {Bone::kLeftFoot, Bone::kRightFoot}) {
      const int ankle = calibration_.bones[foot].position_joint;
      for (const SkeletonPoint& point : points_below(skeleton_, ankle)) {
        const Eigen::Vector3d place = places_[point.joint] + turns_[point.joint] * point.offset;
        lowest = std::min(lowest.value_or(place.z()), place.z());
      }
    }
    return lowest;
  }

 private:
  const Skeleton& skeleton_;
  const Calibration& calibration_;
  const std::vector<Eigen::Quaterniond> turns_;
  std::vector<Eigen::Vector3d> places_;
};

// A bone shorter than this has no direction.
constexpr double kNoLength = 1e-12;

}  // namespace

std::vector<Eigen::Quaterniond> t_pose_rotations(const Skeleton& skeleton,
                                                 const Calibration& calibration) {
  std::vector<std::optional<Bone>> bones(static_cast<std::size_t>(skeleton.joint_count()));
  for (auto at = kMappedBones.rbegin(); at != kMappedBones.rend(); ++at) {
    const Bone bone = *at;
    const int joint = calibration.bones[bone].rotation_joint;
    if (joint >= 0) bones[joint] = bone;
  }
  const Eigen::Quaterniond human_from_source(calibration.human_from_source);
  std::vector<Eigen::Quaterniond> rotations;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (bones[joint]) {
      Eigen::Quaterniond turn(canonical_t_pose(*bones[joint]));
      const auto& axes = calibration.bones[*bones[joint]].joint_from_bone;
      if (axes) turn = turn * axes->conjugate();
      rotations.push_back(turn.normalized());
    } else {
      const int parent = skeleton.joint(joint).parent;
      rotations.push_back(parent < 0 ? human_from_source : rotations[parent]);
    }
  }
  return rotations;
}

void Leaving::add(const Eigen::Vector3d& from_source, const Eigen::Vector3d& from_target) {
  if (from_source.norm() < kNoLength || from_target.norm() < kNoLength) return;
  source.push_back(from_source.normalized());
  target.push_back(from_target.normalized());
}

Leaving leaving_of(const Skeleton& source, const Skeleton& target, const std::vector<int>& twins,
                   int joint, const Eigen::Quaterniond& turn) {
  Leaving leaving;
  for (int child = joint + 1; child < target.joint_count(); ++child) {
    if (target.joint(child).parent != joint || twins[child] < 0) continue;
    leaving.add(turn * source.joint(twins[child]).offset, target.joint(child).offset);
  }
  const auto& sites = source.joint(twins[joint]).end_sites;
  const auto& target_sites = target.joint(joint).end_sites;
  for (std::size_t i = 0; i < std::min(sites.size(), target_sites.size()); ++i) {
    leaving.add(turn * sites[i], target_sites[i]);
  }
  return leaving;
}

Eigen::Quaterniond rest_turn(const Leaving& leaving) {
  if (leaving.source.empty()) return Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < leaving.source.size(); ++i) {
    covariance += leaving.target[i] * leaving.source[i].transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Collinear directions leave the rotation about them undetermined: use the minimal rotation.
  constexpr double kOneLine = 1e-9;
  if (svd.singularValues()[1] < kOneLine * svd.singularValues()[0]) {
    return rotation_between(leaving.source[0], leaving.target[0]);
  }
  Eigen::Vector3d signs(1.0, 1.0, 1.0);
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs.z() = -1.0;
  const Eigen::Matrix3d turn = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return Eigen::Quaterniond(turn).normalized();
}

std::optional<double> rise_over_soles(const Skeleton& skeleton, const Calibration& calibration,
                                      Bone bone) {
  const BoneSource& from = calibration.bones[bone];
  if (from.position_joint < 0) return std::nullopt;
  const TPose pose(skeleton, calibration);
  const auto lowest = pose.lowest_of_feet();
  if (!lowest) return std::nullopt;
  return (pose.place_of(from).z() - *lowest) * calibration.metres_per_unit;
}

std::optional<double> sole_depth(const Skeleton& skeleton, const Calibration& calibration) {
  return rise_over_soles(skeleton, calibration, Bone::kHips);
}

}  // namespace retarget
