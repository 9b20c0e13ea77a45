#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "formats/scene/scene.h"
#include "retarget/error.h"

namespace retarget {

/// Reads the nodes, skins and animations of a glTF 2.0 file.
///
/// If a VRM extension maps nodes to human bones (VRMC_vrm, VRM, VRMC_vrm_animation), these nodes
/// get VRM's bone names: hips, leftUpperArm, ... Other nodes with such a name get the suffix
/// `_node`.
///
/// @param max_bytes  limit on external files and numbers together; see GltfDocument.
/// @return kInput errors; see GltfDocument.
[[nodiscard]] Result<SceneGraph> read_gltf(std::string_view bytes, const std::string& file_name,
                                           std::size_t max_bytes);

}  // namespace retarget
