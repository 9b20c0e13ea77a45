#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "retarget/error.h"
#include "scene/scene.h"

namespace retarget {

/// Whether bytes are a glTF file: a GLB (a VRM is one), or JSON with glTF's `asset`.
[[nodiscard]] bool looks_like_gltf(std::string_view bytes);

/// Reads the nodes, skins and animations of a glTF 2.0 file.
///
/// Where VRM's extension says which node is which bone of a human (VRMC_vrm, VRM, VRMC_vrm_animation), the
/// nodes get VRM's names of the bones: hips, leftUpperArm, ... Another node of such a name gets
/// `_node` behind it.
///
/// @param max_bytes  of a buffer beside the file.
/// @return kInput errors; see GltfDocument.
[[nodiscard]] Result<Scene> read_gltf(std::string_view bytes, const std::string& file_name,
                                      std::size_t max_bytes);

}  // namespace retarget
