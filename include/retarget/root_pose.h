#pragma once

#include <Eigen/Geometry>
#include <span>

#include "retarget/export.h"
#include "retarget/pose.h"

namespace RETARGET_API retarget {

/// The rotation of the root in a configuration, as it is stored: not normalised.
[[nodiscard]] inline Eigen::Quaterniond root_rotation(std::span<const double> qpos) {
  return {qpos[3], qpos[4], qpos[5], qpos[6]};
}
[[nodiscard]] inline Pose root_pose(std::span<const double> qpos) {
  return {root_rotation(qpos), {qpos[0], qpos[1], qpos[2]}};
}
inline void set_root_rotation(std::span<double> qpos, const Eigen::Quaterniond& rotation) {
  qpos[3] = rotation.w();
  for (int i = 0; i < 3; ++i) qpos[4 + i] = rotation.vec()[i];
}

}  // namespace retarget
