#pragma once

#include <map>
#include <string>

#include "retarget/robot.h"

namespace retarget {

/// Joints of a URDF that others move (`<mimic joint= multiplier= offset=>`), by their names. Empty for
/// files that are no URDF.
[[nodiscard]] std::map<std::string, JointCoupling> urdf_couplings(const std::string& path);

}  // namespace retarget
