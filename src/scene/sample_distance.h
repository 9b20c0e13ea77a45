#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "retarget/triangle_mesh.h"
#include "scene/distance_grid.h"

namespace retarget {

/// A tree of the triangles of a mesh, for winding numbers. The same mesh gives the same tree on
/// every machine.
class TriangleTree {
 public:
  /// @pre the mesh has triangles, and all their corners are finite.
  explicit TriangleTree(const TriangleMesh& mesh);

  /// How often the surface winds around a point: 1 inside a closed mesh whose triangles face
  /// outward, 0 outside, a fraction near holes. Far parts of the surface count as dipoles (Barill
  /// et al., "Fast winding numbers for soups and clouds", 2018); errors are below 0.05.
  [[nodiscard]] double winding_number(const Eigen::Vector3d& point) const;

 private:
  struct Triangle {
    Eigen::Vector3d a, b, c;
  };
  struct Node {
    int begin = 0, end = 0;  // Its triangles.
    int right = -1;          // Its second child; the first one follows it. -1: a leaf.
    Eigen::Vector3d area = Eigen::Vector3d::Zero();    // Sum of area times normal.
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // Of area.
    double radius = 0.0;  // Of a sphere about the centre that encloses the triangles.
  };
  int build(std::vector<int>& order, int begin, int end, const std::vector<Triangle>& triangles,
            const std::vector<Eigen::Vector3d>& centres);
  void summarise(Node& node) const;

  std::vector<Triangle> triangles_;  // In the order of the leaves.
  std::vector<Node> nodes_;          // Depth first.
};

/// The point of a triangle nearest to a point.
[[nodiscard]] Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& point,
                                                  const Eigen::Vector3d& a,
                                                  const Eigen::Vector3d& b,
                                                  const Eigen::Vector3d& c);

/// Samples the signed distance to a mesh at all nodes of a grid, metres, the x index fastest.
/// Distances are exact within a cell of the surface. Farther away, a node takes the nearest of the
/// triangles that its neighbours found (sweeps in eight directions), so a distance can be too large
/// by a small fraction of a cell. The sign is that of the winding number, so surfaces need not be
/// closed: across a hole, the distance passes through zero where the winding number is one half.
/// All triangles may face inward.
[[nodiscard]] std::vector<float> sample_distance(const TriangleMesh& mesh,
                                                 const GridLayout& layout);

}  // namespace retarget
