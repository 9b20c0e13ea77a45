#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Thins points to one per grid cell, the first, so that the density no longer depends on the
/// vertex density of a mesh.
/// @param cell  edge length of a grid cell, in the points' unit.
[[nodiscard]] std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points,
                                                   double cell);

/// Fits one to three capsules (or spheres) tightly around surface points. Another capsule is added
/// only if it reduces the volume considerably. Each capsule has the smallest volume found by a
/// search from the points' principal axes.
/// @param points  at least one, evenly spread (thinned), in the body's frame, metres.
[[nodiscard]] std::vector<CollisionShape> capsules_around(
    int body, const std::vector<Eigen::Vector3d>& points);

/// Returns the volume of a sphere, a capsule or a box, cubic metres.
[[nodiscard]] double volume(const CollisionShape& shape);

}  // namespace retarget
