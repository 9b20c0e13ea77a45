#pragma once

#include <string>

#include "retarget/base/result.h"

struct mjModel_;

namespace retarget {

/// Compiles an MJCF file without its meshes and other assets, for kinematics; the caller owns the
/// model. Checks that it has one free joint, its first, and else hinges and slides.
[[nodiscard]] Result<mjModel_*> load_model(const std::string& path);

}  // namespace retarget
