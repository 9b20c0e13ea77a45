#pragma once

#include <string>

#include "retarget/error.h"
#include "retarget/scene.h"

namespace retarget {

/// Hashes all bodies of a scene with their shapes, including meshes from other files.
[[nodiscard]] Result<std::string> scene_hash(const Scene& scene);

}  // namespace retarget
