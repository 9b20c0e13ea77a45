#include "scene/shape_mesh.h"

#include <numbers>
#include <vector>

#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Type = SceneShape::Type;

constexpr int kSides = 32;
constexpr int kArcs = 8;                 // Of a quarter circle.
constexpr double kPlaneHalfSize = 50.0;  // Metres.

// A circle about the z axis; a point if the radius is 0.
struct Ring {
  double radius, z;
};

// The rings of a quarter circle, from its pole (sign 1: top) to its equator or back.
void add_cap(const SceneShape& shape, double sign, std::vector<Ring>& rings) {
  for (int i = 0; i <= kArcs; ++i) {
    // From the bottom up.
    const int step = sign > 0.0 ? i : kArcs - i;
    const auto angle = portable::sin_cos(0.5 * std::numbers::pi * step / kArcs);
    const bool is_pole = step == kArcs;
    rings.push_back({is_pole ? 0.0 : shape.radius * angle.cosine,
                     sign * (shape.half_length + shape.radius * (is_pole ? 1.0 : angle.sine))});
  }
}

std::vector<Ring> rings_of(const SceneShape& shape) {
  std::vector<Ring> rings;
  if (shape.type == Type::kCylinder) {
    return {{0.0, -shape.half_length},
            {shape.radius, -shape.half_length},
            {shape.radius, shape.half_length},
            {0.0, shape.half_length}};
  }
  SceneShape round = shape;
  if (shape.type == Type::kSphere) round.half_length = 0.0;
  add_cap(round, -1.0, rings);
  // The equators of a sphere's caps are one ring.
  if (round.half_length == 0.0) rings.pop_back();
  add_cap(round, 1.0, rings);
  return rings;
}

// Joins rings, from the bottom up, to a closed surface.
TriangleMesh revolved(const std::vector<Ring>& rings) {
  TriangleMesh mesh;
  std::vector<int> first;
  for (const Ring& ring : rings) {
    first.push_back(static_cast<int>(mesh.vertices.size()));
    const int count = ring.radius == 0.0 ? 1 : kSides;
    for (int side = 0; side < count; ++side) {
      const auto angle = portable::sin_cos(2.0 * std::numbers::pi * side / kSides);
      mesh.vertices.emplace_back(ring.radius * angle.cosine, ring.radius * angle.sine, ring.z);
    }
  }
  const auto vertex = [&](std::size_t ring, int side) {
    return first[ring] + (rings[ring].radius == 0.0 ? 0 : side % kSides);
  };
  for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring) {
    for (int side = 0; side < kSides; ++side) {
      const int a = vertex(ring, side), b = vertex(ring, side + 1);
      const int c = vertex(ring + 1, side + 1), d = vertex(ring + 1, side);
      if (a != b) mesh.triangles.push_back({a, b, c});
      if (c != d) mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

TriangleMesh box_mesh(const Vector3d& half_size) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d signs((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                         (corner & 4) != 0 ? 1 : -1);
    mesh.vertices.push_back(signs.cwiseProduct(half_size));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh plane_mesh() {
  TriangleMesh mesh;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    mesh.vertices.emplace_back(x * kPlaneHalfSize, y * kPlaneHalfSize, 0.0);
  }
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TriangleMesh in_shape(const SceneShape& shape) {
  switch (shape.type) {
    case Type::kPlane:
      return plane_mesh();
    case Type::kBox:
      return box_mesh(shape.half_size);
    case Type::kMesh:
      return *shape.mesh;
    default:
      return revolved(rings_of(shape));
  }
}

}  // namespace

TriangleMesh mesh_of_shape(const SceneShape& shape) {
  TriangleMesh mesh = in_shape(shape);
  for (Vector3d& vertex : mesh.vertices) vertex = shape.body_from_shape * vertex;
  return mesh;
}

}  // namespace retarget
