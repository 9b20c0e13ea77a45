#pragma once

#include <map>
#include <string>

namespace retarget {

/// Speed limits by joint that a URDF states (`<limit velocity="...">`), above 0; rad/s or m/s.
/// Empty for files that are no URDF.
[[nodiscard]] std::map<std::string, double> urdf_speeds(const std::string& path);

}  // namespace retarget
