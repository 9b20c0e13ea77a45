#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "human/skeleton/posed_body.h"

namespace retarget {

/// Cosine of 25 degrees: the largest angle from the vertical of an upright trunk or shin.
inline constexpr double kUprightCosine = 0.90630778703664996;

/// Mean directions in the poses of a movement, in joint coordinates.
class MovementMeans {
 public:
  /// Keeps references to the body and the poses.
  /// @param up  up axis of the file, unit length.
  MovementMeans(const Body& body, const std::vector<JointPoses>& poses, const Eigen::Vector3d& up);

  [[nodiscard]] const std::vector<JointPoses>& poses() const { return poses_; }
  [[nodiscard]] const Eigen::Vector3d& up() const { return up_; }
  /// Whether the trunk is upright in enough poses to show the axes of the hips.
  [[nodiscard]] bool shows_upright() const;

  /// Mean of a world direction.
  template <typename Direction>
  [[nodiscard]] Eigen::Vector3d mean(int joint, const Direction& direction) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const JointPoses& pose : poses_) {
      sum += pose[joint].rotation.conjugate() * Eigen::Vector3d(direction(pose));
    }
    return sum / static_cast<double>(poses_.size());
  }
  /// Sum of the up axis over the upright poses.
  [[nodiscard]] Eigen::Vector3d vertical_upright(int joint) const;
  [[nodiscard]] Eigen::Vector3d course(int joint, const Segment& segment) const;
  /// Mean direction from the right to the left bone of a pair.
  [[nodiscard]] Eigen::Vector3d line(int joint, LimbBone part) const;
  /// Mean direction from the middle of the hip joints to the torso's joint, vertical in a T-pose.
  [[nodiscard]] Eigen::Vector3d lower_trunk(int joint) const;

  /// Direction of the foot; for an ankle without toes, the direction that the body faces.
  [[nodiscard]] std::optional<Eigen::Vector3d> foot_direction(Side side,
                                                              const JointPoses& pose) const;
  /// Poses with an upright shin in which the ankle is as low as on the floor.
  [[nodiscard]] std::vector<const JointPoses*> flat_poses(Side side) const;

 private:
  const Body& body_;
  const std::vector<JointPoses>& poses_;
  Eigen::Vector3d up_;
  std::vector<const JointPoses*> upright_;
};

}  // namespace retarget
