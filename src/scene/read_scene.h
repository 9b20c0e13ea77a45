#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/scene.h"

namespace retarget {

/// A body of a scene as its file describes it, in a tree.
struct SceneLink {
  SceneBody body;   ///< Body without its pose in the world.
  int parent = -1;  ///< Index of an earlier link; -1: the world.
  Pose parent_from_link;
};

/// Makes bodies of the links that carry shapes, at rest. A link attached to a moving link is part
/// of it, whatever its joint.
[[nodiscard]] std::vector<SceneBody> bodies_of_links(const std::vector<SceneLink>& links);

/// Readers of scenes; the bodies may have names that are empty or not unique, and floors.
/// @param file   the scene's file, which also names it in errors (of any kind).
/// @param reach  bound of sizes and distances in the file, in its unit.
[[nodiscard]] Result<std::vector<SceneBody>> read_json_scene(const std::string& file, double reach);
[[nodiscard]] Result<std::vector<SceneBody>> read_mjcf_scene(const std::string& file, double reach);
[[nodiscard]] Result<std::vector<SceneBody>> read_urdf_scene(const std::string& file, double reach);

/// load_scene() for a file whose unit is not the metre.
/// @param metres_per_unit  the bodies remain in the unit of the file; only the bound of their sizes
///                         and distances, kMaxSceneReach, depends on it.
[[nodiscard]] Result<Scene> load_scene_in_unit(const std::string& file, double metres_per_unit);

}  // namespace retarget
