#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "retarget/scene.h"
#include "retarget/so3.h"
#include "support/temporary_folder.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using Type = SceneShape::Type;

class MirrorSceneTest : public testing::Test {
 protected:
  // An oblique tetrahedron, which differs from its mirror image.
  static std::shared_ptr<const TriangleMesh> tetrahedron() {
    TriangleMesh mesh;
    mesh.vertices = {{0.0, 0.0, 0.0}, {0.5, 0.1, 0.0}, {0.1, 0.4, 0.05}, {0.2, 0.1, 0.6}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    return std::make_shared<const TriangleMesh>(std::move(mesh));
  }

  static SceneBody body_of(Type type) {
    SceneShape shape;
    shape.type = type;
    shape.body_from_shape = {exp_so3({0.4, -0.9, 0.3}), {0.1, -0.2, 0.3}};
    shape.half_size = {0.3, 0.2, 0.1};
    shape.radius = 0.15;
    shape.half_length = 0.25;
    if (type == Type::kMesh) shape.mesh = tetrahedron();
    SceneBody body;
    body.name = "body";
    body.shapes = {shape};
    body.world_from_body = {exp_so3({-0.2, 0.5, 1.1}), {0.7, -0.4, 0.6}};
    return body;
  }

  double distance(const SceneBody& body, const Vector3d& in_world) const {
    const auto field = make_distance_field(body, folder_.path().string());
    if (!field) {
      ADD_FAILURE() << field.error().message;
      return 0.0;
    }
    return field->at(body.world_from_body.inverse() * in_world).distance;
  }

  Vector3d reflected(const Vector3d& point) const {
    return point - 2.0 * plane_.normal * plane_.normal.dot(point - plane_.point);
  }

  const MirrorPlane plane_{{0.3, 0.1, 0.9}, Vector3d(0.6, -0.8, 0.0)};
  const TemporaryFolder folder_;
};

TEST_F(MirrorSceneTest, DistancesToMirroredPointsAreTheSame) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (const Type type :
       {Type::kPlane, Type::kBox, Type::kSphere, Type::kCapsule, Type::kCylinder, Type::kMesh}) {
    Scene scene{"scene", {body_of(type)}};
    const SceneBody original = scene.bodies.front();
    mirror_scene(plane_, scene, {});
    // The grids of the two meshes differ.
    const double tolerance = type == Type::kMesh ? 0.01 : 1e-12;
    double moved = 0.0;
    for (int i = 0; i < 40; ++i) {
      const Vector3d point = original.world_from_body.translation +
                             Vector3d(number(random), number(random), number(random));
      const double expected = distance(original, point);
      EXPECT_NEAR(distance(scene.bodies.front(), reflected(point)), expected, tolerance);
      moved = std::max(moved, std::abs(distance(scene.bodies.front(), point) - expected));
    }
    EXPECT_GT(moved, 0.05);
  }
}

TEST_F(MirrorSceneTest, TwoReflectionsGiveTheOriginal) {
  Scene scene{"scene", {body_of(Type::kMesh)}};
  ObjectTrack track;
  track.world_from_body = {scene.bodies.front().world_from_body};
  track.contacts = {{"left_hand", 0, {1}}, {"seat", 0, {1}}};
  const SceneBody original = scene.bodies.front();
  mirror_scene(plane_, scene, {&track, 1});
  EXPECT_EQ(track.contacts[0].part, "right_hand");
  EXPECT_EQ(track.contacts[1].part, "seat");
  EXPECT_TRUE(track.world_from_body.front().translation.isApprox(
      reflected(original.world_from_body.translation)));
  mirror_scene(plane_, scene, {&track, 1});
  const SceneBody& twice = scene.bodies.front();
  EXPECT_LT((twice.world_from_body.translation - original.world_from_body.translation).norm(),
            1e-12);
  EXPECT_GT(std::abs(twice.world_from_body.rotation.dot(original.world_from_body.rotation)),
            1.0 - 1e-12);
  EXPECT_EQ(twice.shapes.front().mesh->vertices, original.shapes.front().mesh->vertices);
  EXPECT_EQ(twice.shapes.front().mesh->triangles, original.shapes.front().mesh->triangles);
  EXPECT_EQ(track.contacts[0].part, "left_hand");
}

}  // namespace
}  // namespace retarget
