#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "formats/scene/scene.h"
#include "retarget/error.h"

namespace retarget {

/// A body with arms and legs has at least this many joints.
inline constexpr std::size_t kMinBodyJoints = 10;

/// Fraction of the movement from which another skeleton or take competes with the first.
inline constexpr double kRivalShare = 0.5;

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

/// Marks the joints that are bones; they are the same in all takes.
[[nodiscard]] std::vector<bool> mark_bones(const SceneGraph& scene);

/// choose_skeleton() with known bones, for several takes of a scene.
/// @param bones  mark_bones(scene)
[[nodiscard]] Result<SceneSkeleton> choose_skeleton(const SceneGraph& scene,
                                                    const std::vector<bool>& bones, int take,
                                                    const std::string& root,
                                                    const std::string& file_name);

/// A sentence that names the other skeletons of a body's size that move, in this take or in
/// another, and the options that select them; empty if there are none. It uses the names of the
/// roots, or of nodes above them where the roots' names are equal.
[[nodiscard]] std::string other_actors_text(const SceneGraph& scene, const SceneSkeleton& chosen,
                                            int take);

}  // namespace retarget
