#pragma once

#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "formats/scene/scene_skeleton.h"
#include "retarget/error.h"

namespace retarget {

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
