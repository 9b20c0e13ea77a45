#pragma once

#include <cstddef>
#include <string>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "scene/read_scene.h"
#include "scene/scene.h"

namespace retarget {

/// The motion of a scene's skeleton in a take, sampled; see read_scene.
/// @param file_bytes  a clip takes no more memory than in proportion to them.
[[nodiscard]] Result<Clip> clip_of_scene(const Scene& scene, const std::string& file_name,
                                         std::size_t file_bytes, const SceneReadOptions& options);

}  // namespace retarget
