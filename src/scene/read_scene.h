#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

struct SceneReadOptions {
  std::string take;                  ///< Name, or number from 1; empty: the longest that moves.
  std::string root;                  ///< Of one of several skeletons; empty: the one that moves.
  std::optional<double> source_fps;  ///< How often per second to sample; else as the keys are.
  bool skeleton_only = false;        ///< A file without animation is a skeleton without frames.
  std::size_t max_clip_bytes = std::numeric_limits<std::size_t>::max();
};

/// Whether bytes are a file of 3D scenes that is read: FBX, glTF (GLB, VRM), MVNX.
[[nodiscard]] bool looks_like_scene(std::string_view bytes);

/// Reads the motion of a skeleton of an FBX, glTF, VRM or MVNX file; docs/scenes.md.
///
/// The clip is in the file's units and axes, which its origin names. Its zero pose is the pose that skins
/// were bound in, else that of the nodes at rest, and its joints' axes there are the world's
/// (ClipBuilder).
///
/// @param file_name  as the user named it; files beside it are searched for by it.
/// @return kInput errors; kUsage for takes and skeletons that are not there.
[[nodiscard]] Result<Clip> read_scene(std::string_view bytes, const std::string& file_name,
                                      const SceneReadOptions& options = {});

}  // namespace retarget
