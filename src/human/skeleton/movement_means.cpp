#include "human/skeleton/movement_means.h"

#include <algorithm>

#include "retarget/human_skeleton.h"

namespace retarget {

MovementMeans::MovementMeans(const Body& body, const std::vector<JointPoses>& poses,
                             const Eigen::Vector3d& up)
    : body_(body), poses_(poses), up_(up) {
  for (const JointPoses& pose : poses) {
    const auto trunk = trunk_direction(body, pose);
    if (trunk && trunk->dot(up) > kUprightCosine) upright_.push_back(&pose);
  }
}

bool MovementMeans::shows_upright() const {
  constexpr double kLeastShare = 0.2;
  return static_cast<double>(upright_.size()) >= kLeastShare * static_cast<double>(poses_.size());
}

Eigen::Vector3d MovementMeans::vertical_upright(int joint) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const JointPoses* pose : upright_) sum += (*pose)[joint].rotation.conjugate() * up_;
  return sum;
}

Eigen::Vector3d MovementMeans::course(int joint, const Segment& segment) const {
  return mean(joint, [&](const JointPoses& pose) {
    const auto way = along(segment, pose);
    return way ? Eigen::Vector3d(way->normalized()) : Eigen::Vector3d(0, 0, 0);
  });
}

Eigen::Vector3d MovementMeans::line(int joint, LimbBone part) const {
  const int left = body_.joint(side_bone(Side::kLeft, part));
  const int right = body_.joint(side_bone(Side::kRight, part));
  if (left < 0 || right < 0) return Eigen::Vector3d::Zero();
  return mean(joint, [&](const JointPoses& pose) {
    return (pose[left].translation - pose[right].translation).normalized();
  });
}

Eigen::Vector3d MovementMeans::lower_trunk(int joint) const {
  const int left = body_.joint(Bone::kLeftUpLeg), right = body_.joint(Bone::kRightUpLeg);
  const int torso = body_.joint(Bone::kSpine2);
  if (left < 0 || right < 0 || torso < 0) return Eigen::Vector3d::Zero();
  return mean(joint, [&](const JointPoses& pose) {
    const Eigen::Vector3d middle = 0.5 * (pose[left].translation + pose[right].translation);
    return (pose[torso].translation - middle).normalized();
  });
}

std::optional<Eigen::Vector3d> MovementMeans::foot_direction(Side side,
                                                             const JointPoses& pose) const {
  const Segment& foot = body_.segment(side_bone(side, LimbBone::kFoot));
  if (foot.known()) return along(foot, pose);
  const auto axes = body_axes(body_, pose, up_);
  return axes ? std::optional<Eigen::Vector3d>(axes->row(0)) : std::nullopt;
}

std::vector<const JointPoses*> MovementMeans::flat_poses(Side side) const {
  const int ankle = body_.joint(side_bone(side, LimbBone::kFoot));
  std::vector<double> heights;
  for (const JointPoses& pose : poses_) heights.push_back(up_.dot(pose[ankle].translation));
  std::vector<double> sorted = heights;
  const auto tenth = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10);
  std::ranges::nth_element(sorted, tenth);
  std::vector<const JointPoses*> flat;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const auto shin = along(body_.segment(side_bone(side, LimbBone::kLeg)), poses_[i]);
    // 3 cm for an adult.
    const double limit = *tenth + 0.07 * (shin ? shin->norm() : 0.0);
    const bool stands = !shin || shin->normalized().dot(-up_) > kUprightCosine;
    if (stands && heights[i] <= limit) flat.push_back(&poses_[i]);
  }
  return flat;
}

}  // namespace retarget
