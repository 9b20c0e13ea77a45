#include "io/gltf_mesh.h"

#include <numbers>

#include "math/so3.h"
#include "math/trigonometry.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kSegments = 20;  // around
constexpr int kRings = 5;                // of a half sphere, its equator among them

}  // namespace

void GltfMesh::add_vertex(const Pose& pose, const Vector3d& place, const Vector3d& normal) {
  const Vector3d in_body = pose * place, turned = pose.rotation * normal;
  for (const double value : in_body) positions.push_back(static_cast<float>(value));
  for (const double value : turned) normals.push_back(static_cast<float>(value));
}

void GltfMesh::add_capsule(const Pose& pose, double radius, double half_length) {
  const auto first = static_cast<std::uint32_t>(vertex_count());
  const auto add_ring = [&](int ring, double end) {
    const auto [sine, cosine] = portable::sin_cos(0.5 * std::numbers::pi * ring / kRings);
    for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
      const auto around = portable::sin_cos(2.0 * std::numbers::pi * segment / kSegments);
      const Vector3d normal(cosine * around.cosine, cosine * around.sine, sine);
      add_vertex(pose, radius * normal + end * Vector3d::UnitZ(), normal);
    }
  };
  // from pole to pole, the equators of both ends apart
  add_vertex(pose, {0.0, 0.0, -radius - half_length}, -Vector3d::UnitZ());
  std::uint32_t rings = 0;
  for (int ring = 1 - kRings; ring <= 0; ++ring, ++rings) add_ring(ring, -half_length);
  for (int ring = half_length > 0.0 ? 0 : 1; ring < kRings; ++ring, ++rings) {
    add_ring(ring, half_length);
  }
  add_vertex(pose, {0.0, 0.0, radius + half_length}, Vector3d::UnitZ());

  const std::uint32_t last = first + 1 + rings * kSegments;
  for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
    const std::uint32_t next = (segment + 1) % kSegments;
    const std::uint32_t top = last - kSegments;
    triangles.insert(triangles.end(), {first, first + 1 + next, first + 1 + segment});
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const std::uint32_t low = first + 1 + ring * kSegments, high = low + kSegments;
      triangles.insert(triangles.end(), {low + segment, low + next, high + next, low + segment,
                                         high + next, high + segment});
    }
    triangles.insert(triangles.end(), {last, top + segment, top + next});
  }
}

void GltfMesh::add_line(const Vector3d& from, const Vector3d& to, double radius) {
  const Vector3d way = to - from;
  add_capsule({rotation_between(Vector3d::UnitZ(), way), 0.5 * (from + to)}, radius,
              0.5 * way.norm());
}

void GltfMesh::add_box(const Pose& pose, const Vector3d& half_size) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const auto corner = static_cast<std::uint32_t>(vertex_count());
      const Vector3d normal = sign * Vector3d::Unit(axis);
      Vector3d a = Vector3d::Unit((axis + 1) % 3), b = Vector3d::Unit((axis + 2) % 3);
      if (sign < 0.0) std::swap(a, b);
      for (const Vector3d& place : {Vector3d(normal - a - b), Vector3d(normal + a - b),
                                    Vector3d(normal + a + b), Vector3d(normal - a + b)}) {
        add_vertex(pose, half_size.cwiseProduct(place), normal);
      }
      triangles.insert(triangles.end(),
                       {corner, corner + 1, corner + 2, corner, corner + 2, corner + 3});
    }
  }
}

void GltfMesh::add_shape(const CollisionShape& shape) {
  if (shape.type == CollisionShape::Type::kBox) {
    add_box(shape.body_from_shape, shape.half_size);
  } else {
    add_capsule(shape.body_from_shape, shape.radius,
                shape.type == CollisionShape::Type::kCapsule ? shape.half_length : 0.0);
  }
}

GltfWriter::Json gltf_primitive(GltfWriter& writer, const GltfMesh& mesh, int material) {
  const int positions = writer.add_floats(mesh.positions, 3, GltfWriter::Use::kVertices);
  const int normals = writer.add_floats(mesh.normals, 3, GltfWriter::Use::kVertices);
  return {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
          {"indices", writer.add_indices(mesh.triangles)},
          {"material", material}};
}

}  // namespace retarget
