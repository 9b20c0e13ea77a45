#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "retarget/error.h"

namespace retarget {

/// A body with arms and legs has at least this many joints.
inline constexpr std::size_t kMinBodyJoints = 10;

/// A skeleton of a scene: a subset of its nodes, in depth-first order with parents first.
struct SceneSkeleton {
  std::vector<int> joints;   ///< Node indices.
  std::vector<int> parents;  ///< Parent of each joint, as an index into `joints`; -1: the root.
  std::vector<std::string> others;  ///< Roots of other skeletons of a body's size.
};

/// Chooses the skeleton of a scene.
///
/// Joints are limbs, joints of skins and the nodes between them. If these are too few for a body,
/// joints are the nodes that move in the take, because some programs write skeletons as plain
/// nodes. A moving node on which a torso and two legs hang is a joint, too. Each tree of joints is
/// a skeleton. Without a root name, the skeleton with the most moving joints is chosen.
///
/// @param take  -1: none; the choice depends on size alone.
/// @param root  name of the root or of a node above it; if no node has it, the number of a skeleton
///     of a body's size, from 1; empty: none.
/// @return kInput errors: no joints; several skeletons without a clear choice. kUsage: no skeleton
///     of that name.
[[nodiscard]] Result<SceneSkeleton> choose_skeleton(const SceneGraph& scene, int take,
                                                    const std::string& root,
                                                    const std::string& file_name);

/// A sentence that names the other skeletons of a body's size that move, in this take or in
/// another, and the options that select them; empty if there are none. It uses the names of the
/// roots, or of nodes above them where the roots' names are equal.
[[nodiscard]] std::string other_actors_text(const SceneGraph& scene, const SceneSkeleton& chosen,
                                            int take);

/// Returns for each node whether it affects the positions of a skeleton's joints, as the joints and
/// all nodes above the root do.
[[nodiscard]] std::vector<bool> nodes_of_chain(const SceneGraph& scene,
                                               const SceneSkeleton& skeleton);

/// A skeleton, and the take that moves it.
struct SceneMotionChoice {
  int take = -1;  ///< -1: no take has keys of the skeleton; the skeleton is then empty unless
                  ///< requested alone.
  SceneSkeleton skeleton;
  double begin = 0.0, end = 0.0;    ///< Seconds, from the first to the last key that moves the
                                    ///< skeleton.
  bool moves = false;               ///< Whether the keys differ.
  std::vector<std::string> longer;  ///< Longer takes that move only a small part of the body.
};

/// Sets the interval of a choice from the first to the last key of the chain, clipped to the take.
void set_extent(const SceneGraph& scene, const std::vector<bool>& chain, SceneMotionChoice& choice);

/// Chooses a take by name or number (from 1) and the matching skeleton. Without a take, chooses the
/// longest one of those that move at least half as much of their skeleton as the one that moves
/// most, by length of bones; of equally long ones, the first.
///
/// Keys of cameras and other objects are ignored. A take whose keys are all equal is chosen only if
/// no other take has keys.
///
/// @param skeleton_only  accept a requested take without keys of the skeleton.
/// @return the errors of choose_skeleton(); kUsage: no such take, or a take without keys of the
///     skeleton.
[[nodiscard]] Result<SceneMotionChoice> choose_motion(const SceneGraph& scene,
                                                      const std::string& wanted_take,
                                                      const std::string& root, bool skeleton_only,
                                                      const std::string& file_name);

}  // namespace retarget
