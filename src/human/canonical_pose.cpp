#include "human/canonical_pose.h"

#include <string_view>

#include "human/bones.h"

namespace retarget {
namespace {

Eigen::Matrix3d columns(const Eigen::Vector3d& x, const Eigen::Vector3d& y,
                        const Eigen::Vector3d& z) {
  Eigen::Matrix3d axes;
  axes << x, y, z;
  return axes;
}

// the foot's slope from ankle to ball, 25 degrees
constexpr double kSineOfPitch = 0.42261826174069944;
constexpr double kCosineOfPitch = 0.90630778703664996;

}  // namespace

Eigen::Matrix3d canonical_t_pose(int bone) {
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const std::string_view name = kBoneNames[static_cast<std::size_t>(bone)];
  if (name.ends_with("Leg")) return columns(-up, forward, -left);
  if (name.ends_with("Toe") || name.ends_with("FootMod")) return columns(forward, up, -left);
  if (name.ends_with("Foot")) {
    return columns(kCosineOfPitch * forward - kSineOfPitch * up,
                   kSineOfPitch * forward + kCosineOfPitch * up, -left);
  }
  if (name.starts_with("Left")) return columns(left, -forward, up);
  if (name.starts_with("Right")) return columns(-left, -forward, -up);
  return columns(up, forward, left);
}

}  // namespace retarget
