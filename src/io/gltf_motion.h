#pragma once

#include <string>
#include <vector>

#include "io/gltf_writer.h"
#include "retarget/motion_io.h"

namespace retarget {

/// A robot's motion as a GLB: a node for each body below one that turns Y up, with a mesh of the
/// body's shapes and an animation; beside it the human, where there is one.
/// @param name  of the animation.
[[nodiscard]] Result<std::string> format_robot_glb(const RobotClip& clip, const HumanInWorld* human,
                                                   const std::string& name);

/// Adds a human's skeleton as a skin of simple bones, and its motion to an animation.
/// @return the scene's nodes: the skeleton's, and the mesh's if it has bones.
[[nodiscard]] std::vector<int> add_gltf_human(GltfWriter& writer, const HumanInWorld& human,
                                              GltfAnimation& animation);

}  // namespace retarget
