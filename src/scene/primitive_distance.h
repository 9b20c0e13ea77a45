#pragma once

#include <Eigen/Core>

#include "retarget/scene.h"

namespace retarget {

/// Signed distances to solids in their own frames, metres. Outside they are exact and their normals
/// are continuous. Where several surface points are equally near, inside a solid, one rule decides:
/// the top before the bottom, z before y before x, and +x for an axis of rotation.

/// The half space below z = 0.
[[nodiscard]] SurfaceDistance distance_to_plane(const Eigen::Vector3d& point);
/// @param half_size  not negative, metres.
[[nodiscard]] SurfaceDistance distance_to_box(const Eigen::Vector3d& half_size,
                                              const Eigen::Vector3d& point);
[[nodiscard]] SurfaceDistance distance_to_sphere(double radius, const Eigen::Vector3d& point);
/// @param half_length  half of the distance between the centres of the ends, metres.
[[nodiscard]] SurfaceDistance distance_to_capsule(double radius, double half_length,
                                                  const Eigen::Vector3d& point);
/// @param half_length  half of the height along z, metres.
[[nodiscard]] SurfaceDistance distance_to_cylinder(double radius, double half_length,
                                                   const Eigen::Vector3d& point);

}  // namespace retarget
