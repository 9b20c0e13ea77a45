#pragma once

#include <string>

namespace retarget {

/// Replaces the materials of a URDF by spaces, so that positions in the text stay the same. They
/// have no effect on kinematics.
[[nodiscard]] std::string without_materials(std::string text);

}  // namespace retarget
