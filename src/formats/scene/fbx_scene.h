#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "formats/scene/scene.h"
#include "retarget/error.h"

namespace retarget {

/// Reads the nodes and animations of an FBX file with ufbx. Meshes, textures and other content are
/// ignored. Files that it refers to are never opened.
///
/// ufbx evaluates pre- and post-rotations, axis orders, pivots, layers and scale inheritance. The
/// result is a plain transform relative to the parent.
///
/// @param max_bytes  memory limit for files of any size; a file that needs more is rejected.
/// @return kInput errors.
[[nodiscard]] Result<SceneGraph> read_fbx(std::string_view bytes, const std::string& file_name,
                                          std::size_t max_bytes);

}  // namespace retarget
