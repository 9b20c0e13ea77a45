#pragma once

#include <string>

#include "retarget/error.h"

namespace retarget {

/// Hashes all bodies of a scene with their shapes, including meshes from other files.
/// Errors: those of load_scene.
[[nodiscard]] Result<std::string> scene_hash(const std::string& file);

}  // namespace retarget
