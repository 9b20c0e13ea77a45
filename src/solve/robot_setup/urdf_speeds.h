#pragma once

#include <map>
#include <string>

namespace retarget {

/// Returns the joint speed limits stated in a URDF (`<limit velocity="...">`), above 0; rad/s or
/// m/s. Empty for files that are not URDF.
[[nodiscard]] std::map<std::string, double> urdf_speeds(const std::string& path);

}  // namespace retarget
