#pragma once

#include <vector>

#include "retarget/triangle_mesh.h"
#include "scene/distance_grid.h"

namespace retarget {

/// Samples the signed distance to a mesh at all nodes of a grid, metres, the x index fastest.
///
/// Distances are exact within a cell of the surface. Farther away, a node takes the nearest of the
/// triangles that its neighbours found (sweeps in eight directions), so a distance can be too large
/// by a small fraction of a cell. The sign is that of the winding number, so surfaces need not be
/// closed: across a hole, the distance passes through zero where the surface winds around a point
/// half a time. The triangles may all face inward.
[[nodiscard]] std::vector<float> sample_distance(const TriangleMesh& mesh,
                                                 const GridLayout& layout);

}  // namespace retarget
