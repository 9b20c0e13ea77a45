#include "edit/rest_frames.h"

#include <Eigen/SVD>
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "retarget/edit.h"
#include "retarget/human_skeleton.h"
#include "retarget/pose.h"
#include "retarget/skeleton_points.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "retarget/try.h"

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

// Returns the index in the source of each target joint's counterpart.
Result<std::vector<int>> match_joints(const Skeleton& source, const Skeleton& target,
                                      const std::string& file, const std::string& target_file) {
  std::vector<int> twins;
  for (const Joint& joint : target.joints()) {
    for (const auto& [skeleton, name] :
         {std::pair(&source, &file), std::pair(&target, &target_file)}) {
      if (std::ranges::count(skeleton->joints(), joint.name, &Joint::name) > 1) {
        return input_failure(*name, "several joints are called \"" + joint.name + "\"",
                             "rename all but one of them");
      }
    }
    const auto twin = source.find(joint.name);
    if (!twin) {
      return input_failure(file, "no joint \"" + joint.name + "\" as in " + target_file +
                                     did_you_mean(joint.name, source.names()));
    }
    const int parent = source.joint(*twin).parent;
    const std::string above = parent < 0 ? "" : source.joint(parent).name;
    if (above != (joint.parent < 0 ? "" : target.joint(joint.parent).name)) {
      return input_failure(
          file, "the joint \"" + joint.name + "\" has a different parent than in " + target_file,
          "use retarget edit transfer for different joint trees");
    }
    twins.push_back(*twin);
  }
  if (source.joint_count() != target.joint_count()) {
    for (const Joint& joint : source.joints()) {
      if (target.find(joint.name)) continue;
      return input_failure(target_file, "no joint \"" + joint.name + "\" as in " + file);
    }
  }
  return twins;
}

class RestChanger {
 public:
  RestChanger(const Clip& clip, const std::shared_ptr<const Skeleton>& target,
              std::vector<int> twins)
      : clip_(clip), target_(target), twins_(std::move(twins)) {
    for (int joint = 0; joint < target_->joint_count(); ++joint) {
      turns_.push_back(rest_turn(leaving_of(clip.skeleton(), *target, twins_, joint)));
    }
  }

  RestChange run() const;

 private:
  [[nodiscard]] Eigen::Quaterniond turn_above(int joint) const {
    const int parent = target_->joint(joint).parent;
    return parent < 0 ? Eigen::Quaterniond::Identity() : turns_[parent];
  }
  [[nodiscard]] double distance(const Clip& changed, int frame) const;

  const Clip& clip_;
  const std::shared_ptr<const Skeleton>& target_;
  const std::vector<int> twins_;  // One per target joint: index of its counterpart in the source.
  std::vector<Eigen::Quaterniond> turns_;  // Rotation Q by target joint.
};

RestChange RestChanger::run() const {
  RestChange result{{Clip(target_, clip_.rate(), clip_.frame_count())}};
  for (int frame = 0; frame < clip_.frame_count(); ++frame) {
    const auto source = clip_.rotations(frame);
    const auto rotations = result.clip.rotations(frame);
    const auto translations = result.clip.translations(frame);
    for (int joint = 0; joint < target_->joint_count(); ++joint) {
      const int twin = twins_[joint];
      rotations[joint] = turn_above(joint) * source[twin] * turns_[joint].conjugate();
      const int slot = target_->translation_slot(joint);
      if (slot < 0) continue;
      const bool moves = clip_.skeleton().translation_slot(twin) >= 0;
      translations[slot] = moves
                               ? Eigen::Vector3d(turn_above(joint) * clip_.translation(frame, twin))
                               : target_->joint(joint).offset;
    }
    result.largest_distance = std::max(result.largest_distance, distance(result.clip, frame));
  }
  result.notes = {
      {"moved", "no joint by more than " + number_text(result.largest_distance, 6) + " units"}};
  return result;
}

double RestChanger::distance(const Clip& changed, int frame) const {
  std::vector<Pose> before(clip_.skeleton().joint_count()), after(target_->joint_count());
  forward_kinematics(clip_, frame, before);
  forward_kinematics(changed, frame, after);
  double largest = 0.0;
  for (int joint = 0; joint < target_->joint_count(); ++joint) {
    const Pose& was = before[twins_[joint]];
    largest = std::max(largest, (was.translation - after[joint].translation).norm());
    const auto& sites = clip_.skeleton().joint(twins_[joint]).end_sites;
    const auto& target_sites = target_->joint(joint).end_sites;
    for (std::size_t i = 0; i < std::min(sites.size(), target_sites.size()); ++i) {
      largest = std::max(largest, (was * sites[i] - after[joint] * target_sites[i]).norm());
    }
  }
  return largest;
}

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

Result<RestChange> change_rest(const Clip& clip, const std::shared_ptr<const Skeleton>& target,
                               const std::string& file, const std::string& target_file) {
  RETARGET_TRY_ASSIGN(auto twins, match_joints(clip.skeleton(), *target, file, target_file));
  return RestChanger(clip, target, std::move(twins)).run();
}

}  // namespace retarget
