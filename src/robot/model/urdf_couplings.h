#pragma once

#include <map>
#include <string>

#include "retarget/robot.h"

namespace retarget {

/// Returns the coupled joints of a URDF (`<mimic joint= multiplier= offset=>`), by joint name.
/// Empty for files that are not URDF.
[[nodiscard]] std::map<std::string, JointCoupling> urdf_couplings(const std::string& path);

}  // namespace retarget
