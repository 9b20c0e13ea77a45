#include "human/skeleton/body_axes.h"

#include "retarget/human.h"

namespace retarget {
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
  return told_axes(left.normalized().cross(up), up);
}

BodyFromFile told_axes(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
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

}  // namespace retarget
