#pragma once

#include <string>
#include <vector>

#include "retarget/error.h"
#include "scene/scene.h"

namespace retarget {

/// A skeleton of a scene: some of its nodes, parents first and each followed by what hangs from it.
struct SceneSkeleton {
  std::vector<int> joints;          ///< Nodes.
  std::vector<int> parents;         ///< Of each joint, by its place in `joints`; -1: the root.
  std::vector<std::string> others;  ///< Roots of the scene's other skeletons.
};

/// Chooses the skeleton of a scene.
///
/// Joints are limbs, joints of skins and what lies between them. Where these are too few for a body,
/// they are the nodes that move in the take, as some programs write skeletons of plain nodes. Each tree
/// of them is a skeleton; without a name that one is taken of whose joints most move.
///
/// @param take  -1: none; sizes alone decide.
/// @param root  the root's name, or that of a node above it; empty: none.
/// @return kInput errors: no joints; several skeletons of which none is plainly the one that moves; kUsage:
///     no skeleton of that name.
[[nodiscard]] Result<SceneSkeleton> choose_skeleton(const Scene& scene, int take,
                                                    const std::string& root,
                                                    const std::string& file_name);

/// Chooses a take by name or number (from 1); without either the longest in which a joint moves, of
/// several the first. -1: the scene has none that moves.
[[nodiscard]] Result<int> choose_take(const Scene& scene, const std::string& wanted,
                                      const std::string& file_name);

}  // namespace retarget
