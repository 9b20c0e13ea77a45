#include "solve/hands/hand_posture.h"

#include <algorithm>

#include "retarget/trigonometry.h"

namespace retarget {

void HandPosture::set_joint(std::size_t index, double position) {
  const HandJoint& joint = hand_.joints[index];
  const double by = position - joint.reference;
  Pose moved;
  if (joint.slides) {
    moved.translation.z() = by;
  } else {
    const auto [sine, cosine] = portable::sin_cos(0.5 * by);
    moved.rotation = Eigen::Quaterniond(cosine, 0.0, 0.0, sine);
  }
  const Pose local = joint.parent_from_joint * moved;
  palm_from_joint_[index] = joint.parent < 0 ? local : palm_from_joint(joint.parent) * local;
}

Eigen::Vector3d HandPosture::point(const RobotFinger& finger, int k, int& joint) const {
  if (k == static_cast<int>(finger.corners.size())) {
    joint = finger.joints.back();
    return tip(finger);
  }
  joint = finger.corners[static_cast<std::size_t>(k)];
  return palm_from_joint(joint).translation;
}

double HandPosture::gap(const RobotFinger& finger) const {
  const RobotFinger& thumb = *hand_.find(Finger::kThumb);
  return (tip(thumb) - tip(finger)).norm() - thumb.tip_radius - finger.tip_radius;
}

void HandPosture::directions(const RobotFinger& finger, HandTarget::Parts& parts) const {
  parts.count = std::min(static_cast<int>(finger.corners.size()), HandTarget::Parts::kMaxParts);
  for (int k = 0; k < parts.count; ++k) {
    int joint = 0;
    const Eigen::Vector3d from = point(finger, k, joint), to = point(finger, k + 1, joint);
    parts.directions[static_cast<std::size_t>(k)] =
        hand_.palm_axes.transpose() * (to - from).normalized();
  }
}

}  // namespace retarget
