#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// A surface of triangles; corners are indices into the vertices.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< Metres.
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace retarget
