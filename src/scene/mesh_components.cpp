// Components of meshes, and those among them that are boxes.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "scene/scene_shapes.h"

namespace retarget {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Relative to the size of a box; files have about seven digits.
constexpr double kSame = 1e-5;

// Gives equal vertices one index, and drops triangles without area.
TriangleMesh welded(const TriangleMesh& mesh) {
  TriangleMesh result;
  std::map<std::array<double, 3>, int> known;
  std::vector<int> index_of;
  index_of.reserve(mesh.vertices.size());
  for (const Vector3d& v : mesh.vertices) {
    // Adding zero makes -0 and 0 the same.
    const auto [found, is_new] = known.try_emplace({v.x() + 0.0, v.y() + 0.0, v.z() + 0.0},
                                                   static_cast<int>(result.vertices.size()));
    if (is_new) result.vertices.push_back(v);
    index_of.push_back(found->second);
  }
  for (const auto& triangle : mesh.triangles) {
    std::array<int, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = index_of[static_cast<std::size_t>(triangle[i])];
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    result.triangles.push_back(corners);
  }
  return result;
}

// Sets of vertices that triangles connect.
class Components {
 public:
  explicit Components(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }
  int root(int vertex) {
    while (parent(vertex) != vertex) {
      parent(vertex) = parent(parent(vertex));
      vertex = parent(vertex);
    }
    return vertex;
  }
  void join(int a, int b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent(high) = low;
  }

 private:
  int& parent(int vertex) { return parents_[static_cast<std::size_t>(vertex)]; }
  std::vector<int> parents_;
};

// The parts of a mesh in the order of their first vertices.
std::vector<TriangleMesh> components_of(const TriangleMesh& mesh) {
  Components sets(mesh.vertices.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.join(a, b);
    sets.join(a, c);
  }
  std::map<int, TriangleMesh> parts;
  std::vector<int> index_of(mesh.vertices.size(), -1);
  for (const auto& triangle : mesh.triangles) {
    TriangleMesh& part = parts[sets.root(triangle[0])];
    std::array<int, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      int& index = index_of[static_cast<std::size_t>(triangle[i])];
      if (index < 0) {
        index = static_cast<int>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[static_cast<std::size_t>(triangle[i])]);
      }
      corners[i] = index;
    }
    part.triangles.push_back(corners);
  }
  std::vector<TriangleMesh> result;
  result.reserve(parts.size());
  for (auto& [root, part] : parts) result.push_back(std::move(part));
  return result;
}

// Returns three edges from the first vertex that span a box with all eight vertices as corners.
std::optional<Matrix3d> edges_of(const std::vector<Vector3d>& vertices, double tolerance) {
  const auto is_vertex = [&](const Vector3d& point) {
    return std::ranges::any_of(vertices,
                               [&](const Vector3d& v) { return (v - point).norm() <= tolerance; });
  };
  const auto edge = [&](std::size_t i) -> Vector3d { return vertices[i] - vertices[0]; };
  const auto are_square = [](const Vector3d& a, const Vector3d& b) {
    return std::abs(a.dot(b)) <= 10.0 * kSame * a.norm() * b.norm();
  };
  for (std::size_t i = 1; i < 8; ++i) {
    for (std::size_t j = i + 1; j < 8; ++j) {
      if (!are_square(edge(i), edge(j))) continue;
      for (std::size_t k = j + 1; k < 8; ++k) {
        if (!are_square(edge(i), edge(k)) || !are_square(edge(j), edge(k))) continue;
        const Vector3d a = edge(i), b = edge(j), c = edge(k);
        const Vector3d& o = vertices[0];
        if (!is_vertex(o + a + b) || !is_vertex(o + b + c) || !is_vertex(o + a + c) ||
            !is_vertex(o + a + b + c)) {
          continue;
        }
        return (Matrix3d() << a, b, c).finished();
      }
    }
  }
  return std::nullopt;
}

// Whether two triangles cover each face of the box with these axes, so that there are no holes.
bool covers_faces(const TriangleMesh& mesh, const Matrix3d& axes, const Vector3d& centre,
                  const Vector3d& half, double tolerance) {
  std::array<double, 6> areas{};
  for (const auto& triangle : mesh.triangles) {
    std::array<Vector3d, 3> at;
    for (std::size_t i = 0; i < 3; ++i) {
      at[i] = axes.transpose() * (mesh.vertices[static_cast<std::size_t>(triangle[i])] - centre);
    }
    const double area = 0.5 * (at[1] - at[0]).cross(at[2] - at[0]).norm();
    for (std::size_t face = 0; face < 6; ++face) {
      const auto axis = static_cast<Eigen::Index>(face / 2);
      const double side = face % 2 == 0 ? half[axis] : -half[axis];
      if (std::ranges::all_of(
              at, [&](const Vector3d& p) { return std::abs(p[axis] - side) <= tolerance; })) {
        areas[face] += area;
      }
    }
  }
  for (std::size_t face = 0; face < 6; ++face) {
    const auto axis = static_cast<Eigen::Index>(face / 2);
    const double whole = 4.0 * half[(axis + 1) % 3] * half[(axis + 2) % 3];
    if (std::abs(areas[face] - whole) > 1e-3 * whole) return false;
  }
  return true;
}

// Exchanges and flips the axes of a box so that its rotation is small, and right-handed.
Matrix3d near_identity(Matrix3d edges) {
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    Eigen::Index best = axis;
    for (Eigen::Index other = axis + 1; other < 3; ++other) {
      const auto share = [&](Eigen::Index c) {
        return std::abs(edges(axis, c)) / edges.col(c).norm();
      };
      if (share(other) > share(best)) best = other;
    }
    edges.col(axis).swap(edges.col(best));
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (edges(axis, axis) < 0.0) edges.col(axis) *= -1.0;
  }
  if (edges.determinant() < 0.0) edges.col(2) *= -1.0;
  return edges;
}

std::optional<SceneShape> box_of(const TriangleMesh& mesh) {
  if (mesh.vertices.size() != 8 || mesh.triangles.size() != 12) return std::nullopt;
  Vector3d centre = Vector3d::Zero();
  for (const Vector3d& vertex : mesh.vertices) centre += vertex / 8.0;
  const double tolerance = kSame * 2.0 * (mesh.vertices[0] - centre).norm();
  const auto found = edges_of(mesh.vertices, tolerance);
  if (!found) return std::nullopt;
  const Matrix3d edges = near_identity(*found);
  const Vector3d half = 0.5 * edges.colwise().norm().transpose();
  if (half.minCoeff() <= tolerance) return std::nullopt;
  Matrix3d axes;
  axes.col(0) = edges.col(0).normalized();
  axes.col(2) = axes.col(0).cross(edges.col(1)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  if (!covers_faces(mesh, axes, centre, half, tolerance)) return std::nullopt;
  SceneShape box;
  box.type = SceneShape::Type::kBox;
  box.half_size = half;
  box.body_from_shape = {Eigen::Quaterniond(axes).normalized(), centre};
  return box;
}

void append(TriangleMesh& all, const TriangleMesh& part) {
  const auto offset = static_cast<int>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles) {
    all.triangles.push_back({a + offset, b + offset, c + offset});
  }
}

}  // namespace

std::vector<SceneShape> shapes_of_mesh(const TriangleMesh& mesh, const Pose& body_from_mesh) {
  std::vector<SceneShape> shapes;
  auto rest = std::make_shared<TriangleMesh>();
  for (const TriangleMesh& part : components_of(welded(mesh))) {
    if (auto box = box_of(part)) {
      box->body_from_shape = body_from_mesh * box->body_from_shape;
      shapes.push_back(std::move(*box));
    } else {
      append(*rest, part);
    }
  }
  if (!rest->triangles.empty()) {
    SceneShape shape;
    shape.type = SceneShape::Type::kMesh;
    shape.body_from_shape = body_from_mesh;
    shape.mesh = std::move(rest);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace retarget
