#include "retarget/human_skeleton.h"

#include <optional>

#include "retarget/human.h"

namespace retarget {
namespace {

using enum LimbBone;

Eigen::Matrix3d columns(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                        const Eigen::Vector3d& z) {
  Eigen::Matrix3d axes;
  axes << x, y, z;
  return axes;
}

// The foot slopes down by 25 degrees from the ankle to the ball.
constexpr double kSineOfPitch = 0.42261826174069944;
constexpr double kCosineOfPitch = 0.90630778703664996;

}  // namespace

Eigen::Matrix3d canonical_t_pose(Bone bone) {
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const std::optional<LimbBone> part = limb_bone(bone);
  if (!part) return columns(up, forward, left);
  switch (*part) {
    case kUpLeg:
    case kLeg:
      return columns(-up, forward, -left);
    case kToe:
    case kFootMod:
      return columns(forward, up, -left);
    case kFoot:
      return columns(kCosineOfPitch * forward - kSineOfPitch * up,
                     kSineOfPitch * forward + kCosineOfPitch * up, -left);
    default:
      return side_of(bone) == Side::kLeft ? columns(left, -forward, up)
                                          : columns(-left, -forward, -up);
  }
}

}  // namespace retarget
