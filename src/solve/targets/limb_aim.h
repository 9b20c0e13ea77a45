#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "retarget/pose.h"

namespace retarget {

/// World rotations of the two bones of a limb.
struct LimbAim {
  Eigen::Quaterniond upper = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond lower = Eigen::Quaterniond::Identity();
};

/// Aims a human limb as if its elbow or knee were a hinge: the X axes of both bones point along the
/// limb, their Z axes are perpendicular to the limb's plane. Human bones also rotate about their own axes at
/// elbow and knee; a robot that followed these rotations would have to point its limbs elsewhere.
/// The straighter the limb, the less its plane is defined, so the upper bone's own Z counts more.
/// The hinge is along
///
///     n + (0.1 - min(0, n z)) z,    n = -(u x f)
///
/// with the directions u and f of both bones and the upper bone's Z axis z.
///
/// Returns nothing for a limb without length.
/// @param upper, lower, end  poses of the bones that begin at shoulder, elbow and wrist (hip, knee,
///     ankle), with the axes of canonical_t_pose.
[[nodiscard]] std::optional<LimbAim> aim_limb(const Pose& upper, const Pose& lower,
                                              const Pose& end);

}  // namespace retarget
