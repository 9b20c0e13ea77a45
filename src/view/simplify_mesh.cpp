#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>

#include "view/triangle_mesh.h"

namespace retarget {
namespace {

using Cell = std::array<std::int64_t, 3>;
using Corners = std::array<int, 3>;

// Hash containers are only used for lookup, because their iteration order depends on the library.
struct Hash {
  template <typename Number>
  std::size_t operator()(const std::array<Number, 3>& numbers) const {
    std::uint64_t hash = 0;
    for (const Number number : numbers) {
      hash = (hash ^ static_cast<std::uint64_t>(number)) * 0x9E3779B97F4A7C15U;
      hash ^= hash >> 29U;
    }
    return static_cast<std::size_t>(hash);
  }
};

// Replaces the vertices of each grid cell by their mean and drops triangles that become degenerate.
// Cells are centred at multiples of the side, so that 0 and -0 share a cell.
TriangleMesh clustered(const TriangleMesh& mesh, double side) {
  struct Cluster {
    int index = 0;
    int count = 0;
  };
  std::unordered_map<Cell, Cluster, Hash> clusters;
  clusters.reserve(mesh.vertices.size() / 4);
  TriangleMesh result;
  std::vector<int> index_of(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d& vertex = mesh.vertices[i];
    Cell cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] =
          static_cast<std::int64_t>(std::nearbyint(vertex[static_cast<Eigen::Index>(axis)] / side));
    }
    Cluster& cluster = clusters[cell];
    if (cluster.count == 0) {
      cluster.index = static_cast<int>(result.vertices.size());
      result.vertices.emplace_back(Eigen::Vector3d::Zero());
    }
    Eigen::Vector3d& mean = result.vertices[static_cast<std::size_t>(cluster.index)];
    mean += (vertex - mean) / ++cluster.count;
    index_of[i] = cluster.index;
  }
  std::unordered_set<Corners, Hash> known;
  known.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    Corners corners = {index_of[static_cast<std::size_t>(a)], index_of[static_cast<std::size_t>(b)],
                       index_of[static_cast<std::size_t>(c)]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    // Rotate the smallest index to the front, which keeps the orientation.
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    if (known.insert(corners).second) result.triangles.push_back(corners);
  }
  return result;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d& corner = mesh.vertices[static_cast<std::size_t>(a)];
    area += 0.5 * (mesh.vertices[static_cast<std::size_t>(b)] - corner)
                      .cross(mesh.vertices[static_cast<std::size_t>(c)] - corner)
                      .norm();
  }
  return area;
}

}  // namespace

TriangleMesh simplified(const TriangleMesh& mesh, std::size_t max_triangles) {
  constexpr double kSame = 1e-5;  // Metres.
  constexpr double kCoarser = 1.3;
  TriangleMesh result = clustered(mesh, kSame);
  if (result.triangles.size() <= max_triangles) return result;
  // A cell has about two triangles. Restart from the first mesh each time, because repeated
  // averaging would move vertices.
  const TriangleMesh first = result;
  double side = 0.7 * std::sqrt(area_of(first) / static_cast<double>(max_triangles));
  for (side = std::max(side, kSame); result.triangles.size() > max_triangles; side *= kCoarser) {
    result = clustered(first, side);
  }
  return result;
}

}  // namespace retarget
