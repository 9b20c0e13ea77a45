#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "scene/scene.h"

namespace retarget {

/// Whether bytes are an FBX file, binary or text.
[[nodiscard]] bool looks_like_fbx(std::string_view bytes);

/// Reads the nodes and animations of an FBX file (ufbx). Meshes, textures and what else it holds are
/// left out, and no other file is opened, whatever it names.
///
/// Rotations before and after the animated one, orders of axes, pivots, layers and the ways to inherit
/// scale are ufbx's; what comes out are plain places in the parent.
///
/// @param max_bytes  of memory, for files of any size; more are refused.
/// @return kInput errors.
[[nodiscard]] Result<Scene> read_fbx(std::string_view bytes, const std::string& file_name,
                                     std::size_t max_bytes);

}  // namespace retarget
