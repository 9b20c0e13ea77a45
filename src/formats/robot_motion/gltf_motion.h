#pragma once

#include <string>
#include <vector>

#include "formats/robot_motion/gltf_writer.h"
#include "retarget/motion_io.h"

namespace retarget {

/// Formats a robot's motion as GLB: a root node that turns Z up into Y up, below it a node per body
/// with a mesh of the body's shapes, and an animation. If `human` is given, its skeleton is added.
/// @param name  of the animation.
[[nodiscard]] Result<std::string> format_robot_glb(const RobotClip& clip, const HumanInWorld* human,
                                                   const std::string& name);

/// Adds a human's skeleton as a skin of simple bones, and its motion to an animation.
/// @return the scene's root nodes: that of the skeleton, and that of the mesh if it has bones.
[[nodiscard]] std::vector<int> add_gltf_human(GltfWriter& writer, const HumanInWorld& human,
                                              GltfAnimation& animation);

}  // namespace retarget
