#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/scene.h"
#include "retarget/triangle_mesh.h"

namespace retarget {

/// Sample positions of a grid: node (i, j, k) lies at origin + spacing * (i, j, k).
struct GridLayout {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< Metres, in the mesh's frame.
  double spacing = 0.0;                              ///< Metres.
  std::array<int, 3> nodes{};                        ///< Number of nodes per axis.

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) *
           static_cast<std::size_t>(nodes[2]);
  }
};

/// Chooses the grid of a mesh: 72 cells along its longest side, cells of at most 2 cm if the limit
/// on nodes permits it, and a margin of 8 cm (4 to 16 cells) on all sides.
/// Errors (kInput, without file): a mesh so large that its cells would exceed 25 cm.
[[nodiscard]] Result<GridLayout> grid_layout(const TriangleMesh& mesh);

/// Samples of the signed distance to a mesh, and a C1 function through them: the cubic Hermite
/// polynomial in each axis, with slopes at the samples from their neighbours (as Catmull-Rom
/// splines) and without twist.
class DistanceGrid {
 public:
  /// @param values  distances by node, the x index fastest, metres.
  DistanceGrid(const GridLayout& layout, const std::vector<float>& values);

  /// Outside the grid, the distance is that to the surface point below the nearest point of the
  /// grid. It continues value and gradient across the border; it is never too small, and exact
  /// where that surface point is the nearest one.
  /// @param point  point in the mesh's frame, metres.
  [[nodiscard]] SurfaceDistance at(const Eigen::Vector3d& point) const;

  [[nodiscard]] const GridLayout& layout() const { return layout_; }
  /// The samples, as the constructor takes them.
  [[nodiscard]] std::vector<float> values() const;

 private:
  // A sample and its changes per cell. The nodes of a row are contiguous in memory.
  struct Node {
    float value, slope_x, slope_y, slope_z;
  };
  struct Sample {
    double value;
    Eigen::Vector3d gradient;
  };
  [[nodiscard]] Sample interpolate(const Eigen::Vector3d& point) const;

  GridLayout layout_;
  double cells_per_metre_ = 0.0;
  Eigen::Vector3d highest_;  // The corner opposite to the origin.
  std::vector<Node> nodes_;
};

/// Name of the file for the grid of a mesh: a hash of its vertices and triangles, of the layout and
/// of the version of the method, and the ending `.grid`.
[[nodiscard]] std::string grid_file_name(const TriangleMesh& mesh, const GridLayout& layout);

/// Reads a grid. Returns nothing if the file is missing or not exactly such a grid: wrong magic
/// number, version, layout, size or check sum.
[[nodiscard]] std::optional<DistanceGrid> read_grid(const std::string& file,
                                                    const GridLayout& layout);

/// Writes a grid, completely or not at all, and makes the folder. Failures are ignored: the grid
/// can be computed again.
void write_grid(const std::string& file, const DistanceGrid& grid);

}  // namespace retarget
