#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/robot.h"

namespace retarget {

/// Points of a surface, no two of which lie in one cell of a grid: as even as the surface, however unevenly
/// a mesh of it has its vertices. The first of a cell stays.
[[nodiscard]] std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points,
                                                   double cell);

/// One to three capsules (or spheres) that hold a surface's points and little else: a further one is taken
/// only where it saves a good part of the volume. Each is the one of least volume found from the points'
/// principal axes onwards.
/// @param points  at least one, spread evenly (thinned), in the body's frame, metres.
[[nodiscard]] std::vector<CollisionShape> capsules_around(
    int body, const std::vector<Eigen::Vector3d>& points);

/// Of a sphere, a capsule or a box, cubic metres.
[[nodiscard]] double volume(const CollisionShape& shape);

}  // namespace retarget
