#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "formats/scene/scene.h"
#include "formats/scene/scene_skeleton.h"

namespace retarget {

/// World positions of all nodes at rest.
[[nodiscard]] std::vector<Eigen::Vector3d> node_rests(const SceneGraph& scene);

/// Marks a node above the joints of a body that is not a joint itself, such as an FBX dummy as
/// pelvis: it moves in a take, and the torso and two equal legs hang on it.
/// @param marks  whether each node is a joint; nodes between joints are marked.
/// @return whether a node was marked.
[[nodiscard]] bool mark_dummy_hips(const SceneGraph& scene, std::vector<bool>& marks);

/// The share of a skeleton's bones, by their length, whose joint moves in a take: 1 for a whole
/// body, nearly 0 for a face or fingers.
/// @param places  node_rests(). @param moves  whether each node moves in the take.
[[nodiscard]] double moving_share(const std::vector<Eigen::Vector3d>& places,
                                  const SceneSkeleton& skeleton, const std::vector<bool>& moves);

/// Removes branches without movement whose joints coincide at rest with moving ones, such as the
/// deforming bones of a rig of which only the controlling bones have keys.
/// @return the number of removed joints.
std::size_t drop_still_copies(const SceneGraph& scene, int take, SceneSkeleton& skeleton);

}  // namespace retarget
