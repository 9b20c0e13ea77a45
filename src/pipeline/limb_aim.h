#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "retarget/pose.h"

namespace retarget {

/// World from bone of a limb's two bones.
struct LimbAim {
  Eigen::Quaterniond upper = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond lower = Eigen::Quaterniond::Identity();
};

/// A human limb as one whose elbow or knee is a hinge: X of each bone along the limb, Z of both
/// square to the plane of the limb. Bones of people turn about their own axes at elbow and knee too;
/// a robot that follows these turns has to point its limbs elsewhere. The straighter the limb, the
/// less its plane says and the more the upper bone's own Z counts: the hinge is along
///
///     n + (0.1 - min(0, n z)) z,    n = -(u x f), u, f: directions of both bones, z: the upper bone's Z
///
/// Nothing for a limb without length.
/// @param upper, lower, end  poses of the bones that begin at shoulder, elbow, wrist (hip, knee,
///                           ankle), with the axes of canonical_t_pose.
[[nodiscard]] std::optional<LimbAim> aim_limb(const Pose& upper, const Pose& lower,
                                              const Pose& end);

}  // namespace retarget
