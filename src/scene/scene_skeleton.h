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

/// Of each node whether it has a part in the places of a skeleton's joints: they and all above the root.
[[nodiscard]] std::vector<bool> nodes_of_chain(const Scene& scene, const SceneSkeleton& skeleton);

/// A skeleton, and the take that moves it.
struct SceneMotionChoice {
  int take = -1;  ///< -1: none has keys of the skeleton, which is empty then
                  ///< unless it alone is wanted.
  SceneSkeleton skeleton;
  double begin = 0.0, end = 0.0;  ///< Seconds; of the keys that move the skeleton.
  bool moves = false;             ///< Whether they differ.
};

/// Chooses a take by name or number (from 1), and the skeleton that is read with it; without either the
/// longest take in which the skeleton moves, of several the first.
///
/// Keys of cameras and other objects count for nothing, and a take whose keys are all the same is
/// chosen only where no other has keys.
///
/// @param skeleton_only  a take without keys of the skeleton may be asked for.
/// @return the errors of choose_skeleton(); kUsage: no such take, or none of its keys is the skeleton's.
[[nodiscard]] Result<SceneMotionChoice> choose_motion(const Scene& scene,
                                                      const std::string& wanted_take,
                                                      const std::string& root, bool skeleton_only,
                                                      const std::string& file_name);

}  // namespace retarget
