// Masses and centres of mass of scene bodies, against closed forms.

#include "scene/body_mass.h"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>

#include "retarget/write_scene.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Type = SceneShape::Type;

// A tetrahedron with a corner at the origin; the fourth triangle closes it.
SceneShape corner_mesh(bool closed, bool inward) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}};
  if (closed) mesh->triangles.push_back({1, 2, 3});
  if (inward) {
    for (auto& triangle : mesh->triangles) std::swap(triangle[0], triangle[1]);
  }
  SceneShape shape;
  shape.type = Type::kMesh;
  shape.mesh = mesh;
  return shape;
}

TEST(BodyMass, ComputesMassesOfPrimitives) {
  SceneBody body;
  SceneShape box;
  box.half_size = {0.1, 0.2, 0.3};
  box.body_from_shape.translation = {1.0, 0.0, 0.0};
  SceneShape capsule;
  capsule.type = Type::kCapsule;
  capsule.radius = 0.1;
  capsule.half_length = 0.2;
  body.shapes = {box, capsule};
  const double of_box = 0.048;
  const double of_capsule = std::numbers::pi * (0.01 * 0.4 + 4.0 / 3.0 * 0.001);
  const BodyMass found = body_mass(body);
  EXPECT_NEAR(found.mass, kObjectDensity * (of_box + of_capsule), 1e-9);
  EXPECT_LT((found.com - Vector3d(of_box / (of_box + of_capsule), 0.0, 0.0)).norm(), 1e-12);
}

TEST(BodyMass, UsesStatedMasses) {
  SceneBody body;
  body.shapes.emplace_back().half_size = Vector3d::Constant(0.1);
  body.mass = 3.5;
  EXPECT_EQ(body_mass(body).mass, 3.5);
}

TEST(BodyMass, ComputesMassesOfMeshes) {
  for (const bool inward : {false, true}) {
    SceneBody body;
    body.shapes = {corner_mesh(true, inward)};
    const BodyMass found = body_mass(body);
    EXPECT_NEAR(found.mass, kObjectDensity / 6.0, 1e-9);
    EXPECT_LT((found.com - Vector3d::Constant(0.25)).norm(), 1e-12);
  }
}

// The open side faces away from the apex of the sum, so this mesh encloses nothing.
TEST(BodyMass, UsesTheBoxOfAMeshWithoutVolume) {
  SceneBody body;
  body.shapes = {corner_mesh(false, false)};
  const BodyMass found = body_mass(body);
  EXPECT_NEAR(found.mass, kObjectDensity, 1e-9);
  EXPECT_LT((found.com - Vector3d::Constant(0.5)).norm(), 1e-12);
}

TEST(BodyMass, PlanesHaveNoMass) {
  SceneBody body;
  body.shapes.emplace_back().type = Type::kPlane;
  EXPECT_EQ(body_mass(body).mass, 0.0);
}

}  // namespace
}  // namespace retarget
