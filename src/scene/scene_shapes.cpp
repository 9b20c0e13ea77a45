#include "scene/scene_shapes.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numbers>
#include <utility>

#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"

namespace retarget {

using Eigen::Vector3d;

std::string reach_text(double reach) {
  return number_text(reach, 0) + (reach == kMaxSceneReach ? " m" : " units of the file");
}

Result<TriangleMesh> load_scene_mesh(const std::string& file, ColladaAxes axes, double reach,
                                     const Vector3d& scale, const Pose& file_from_mesh) {
  TRY_ASSIGN(const auto content, read_mesh_file(file));
  TRY_ASSIGN(TriangleMesh mesh, read_mesh_as_written(content.view(), file, axes));
  if (mesh.triangles.size() > kMaxSceneTriangles) {
    return input_failure(file,
                         "the mesh has " + std::to_string(mesh.triangles.size()) +
                             " triangles: at most " + std::to_string(kMaxSceneTriangles) +
                             " are supported",
                         "simplify the mesh");
  }
  const Pose mesh_from_file = file_from_mesh.inverse();
  for (Vector3d& vertex : mesh.vertices) {
    vertex = scale.cwiseProduct(mesh_from_file * vertex);
    if (!(vertex.cwiseAbs().maxCoeff() <= reach)) {
      return input_failure(file, "a vertex is more than " + reach_text(reach) + " from the origin",
                           "lengths are metres; give a mesh in millimetres the scale 0.001");
    }
  }
  return mesh;
}

Result<TriangleMesh> find_scene_mesh(const std::string& named, const std::string& scene_file,
                                     ColladaAxes axes, double reach, const Vector3d& scale,
                                     const Pose& file_from_mesh) {
  if (const auto file = find_mesh_file(named, scene_file, {})) {
    return load_scene_mesh(file->string(), axes, reach, scale, file_from_mesh);
  }
  // An absolute name replaces the folder.
  if (is_file(std::filesystem::path(scene_file).parent_path() / named)) {
    return input_failure(scene_file,
                         "the mesh file \"" + named + "\" is outside the folders of the scene",
                         "retarget reads meshes only next to the scene file, one folder up, and in "
                         "folders below; copy the mesh there");
  }
  return input_failure(scene_file, "the mesh file \"" + named + "\" does not exist",
                       "retarget searches meshes next to the scene file and one folder up");
}

TriangleMesh height_mesh(const std::vector<double>& heights, std::size_t columns,
                         const Eigen::Vector2d& spacing, double bottom) {
  TriangleMesh mesh;
  const std::size_t rows = heights.size() / columns;
  for (const bool top : {true, false}) {
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t c = 0; c < columns; ++c) {
        mesh.vertices.emplace_back(static_cast<double>(c) * spacing.x(),
                                   static_cast<double>(r) * spacing.y(),
                                   top ? heights[r * columns + c] : bottom);
      }
    }
  }
  const auto below = static_cast<int>(rows * columns);
  // Corners in anticlockwise order, seen from outside.
  const auto add = [&](int a, int b, int c, int d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  const auto node = [&](std::size_t r, std::size_t c) { return static_cast<int>(r * columns + c); };
  for (std::size_t r = 0; r + 1 < rows; ++r) {
    for (std::size_t c = 0; c + 1 < columns; ++c) {
      const std::array<int, 4> cell = {node(r, c), node(r, c + 1), node(r + 1, c + 1),
                                       node(r + 1, c)};
      add(cell[0], cell[1], cell[2], cell[3]);
      add(below + cell[3], below + cell[2], below + cell[1], below + cell[0]);
    }
  }
  const auto wall = [&](int from, int to) { add(below + from, below + to, to, from); };
  for (std::size_t c = 0; c + 1 < columns; ++c) {
    wall(node(0, c), node(0, c + 1));
    wall(node(rows - 1, c + 1), node(rows - 1, c));
  }
  for (std::size_t r = 0; r + 1 < rows; ++r) {
    wall(node(r, columns - 1), node(r + 1, columns - 1));
    wall(node(r + 1, 0), node(r, 0));
  }
  return mesh;
}

TriangleMesh ellipsoid_mesh(const Vector3d& radii) {
  constexpr int kRounds = 4;
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    mesh.vertices.emplace_back(Vector3d::Unit(axis));
    mesh.vertices.emplace_back(-Vector3d::Unit(axis));
  }
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                    {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int round = 0; round < kRounds; ++round) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), 0);
      if (is_new) {
        found->second = static_cast<int>(mesh.vertices.size());
        const Vector3d sum =
            mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)];
        mesh.vertices.push_back(sum.normalized());
      }
      return found->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& part : {std::array{a, ab, ca}, std::array{b, bc, ab}, std::array{c, ca, bc},
                               std::array{ab, bc, ca}}) {
        finer.push_back(part);
      }
    }
    mesh.triangles = std::move(finer);
  }
  for (Vector3d& vertex : mesh.vertices) vertex = vertex.cwiseProduct(radii);
  return mesh;
}

namespace {

using Type = SceneShape::Type;

constexpr int kRingSides = 32;
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
    const int count = ring.radius == 0.0 ? 1 : kRingSides;
    for (int side = 0; side < count; ++side) {
      const auto angle = portable::sin_cos(2.0 * std::numbers::pi * side / kRingSides);
      mesh.vertices.emplace_back(ring.radius * angle.cosine, ring.radius * angle.sine, ring.z);
    }
  }
  const auto vertex = [&](std::size_t ring, int side) {
    return first[ring] + (rings[ring].radius == 0.0 ? 0 : side % kRingSides);
  };
  for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring) {
    for (int side = 0; side < kRingSides; ++side) {
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
