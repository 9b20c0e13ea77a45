#pragma once

#include <Eigen/Core>
#include <span>

#include "retarget/scene.h"

namespace retarget {

/// Converts a scene from other units and axes.
/// @param world_from_file  rotation to the axes of the world
/// @param unit             metres per unit of the file
void bring_to_world(const Eigen::Matrix3d& world_from_file, double unit, Scene& scene,
                    std::span<ObjectTrack> tracks);

/// Scales a body that does not move about the origin of the world, by a factor per axis. Shapes
/// that would not keep their type become meshes.
void scale_static_body(const Eigen::Vector3d& factors, SceneBody& body);

/// Moves and scales the bodies that move, and their tracks. A scaled body keeps its anchors.
/// @param fields  one per body, before the change
/// @param tracks  tracks, each with the name of its body
void change_objects(const Eigen::Vector3d& shift, double scale,
                    std::span<const DistanceField> fields, Scene& scene,
                    std::span<ObjectTrack> tracks);

}  // namespace retarget
