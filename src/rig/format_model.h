#pragma once

#include <string>
#include <vector>

#include "anatomy/shapes.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot as MJCF text without meshes: tree, joints, ranges and inertias to the last digit, and
/// the given shapes as geoms. Bodies and joints must have names.
[[nodiscard]] std::string format_model(const Robot& robot, const std::string& name,
                                       const std::vector<RoughShape>& shapes);

}  // namespace retarget
