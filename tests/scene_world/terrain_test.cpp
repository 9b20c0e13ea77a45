// Stairs and slopes as scenes, and changes of scenes.

#include "scene/terrain.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "scene/change_scene.h"
#include "scene/scene_world.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SceneWorld world_of(Scene scene) {
  auto placed = place_scene(std::make_shared<const Scene>(std::move(scene)), {},
                            {FrameRate{30, 1}, 1, 0, FrameRate{30, 1}, 1});
  return *make_scene_world(*std::move(placed));
}

Terrain tilted_stairs() {
  Terrain terrain;
  terrain.edge = {0.4, -0.2};
  terrain.along = Vector2d(3.0, 4.0).normalized();
  terrain.rise = 0.15;
  terrain.tread = 0.3;
  terrain.count = 4;
  return terrain;
}

void expect_ground(const Terrain& terrain) {
  const SceneWorld world = world_of(terrain_scene(terrain, 3.0, 2.0));
  for (double along = -0.55; along < 2.5; along += 0.1) {
    const Vector2d at = terrain.edge + along * terrain.along;
    const double expected = terrain.height_at(along);
    EXPECT_NEAR(world.ground_below(0, {at.x(), at.y(), 2.0}), expected, 2e-3) << along;
    // Just below the surface, the surface is nearest.
    if (expected == 0.0) continue;
    EXPECT_LT(world.distance(0, 0, {at.x(), at.y(), expected - 0.02}).distance, -0.015) << along;
  }
}

TEST(TerrainScene, HasTheHeightsOfStairs) {
  expect_ground(tilted_stairs());
}

TEST(TerrainScene, HasTheHeightsOfASlope) {
  Terrain terrain;
  terrain.edge = {0.4, -0.2};
  terrain.along = Vector2d(3.0, 4.0).normalized();
  terrain.slope = 0.2;
  expect_ground(terrain);
}

Scene room() {
  Scene scene;
  const auto add = [&](const char* name, SceneShape::Type type, const Vector3d& at) -> SceneShape& {
    SceneBody& body = scene.bodies.emplace_back();
    body.name = name;
    body.world_from_body.translation = at;
    SceneShape& shape = body.shapes.emplace_back();
    shape.type = type;
    return shape;
  };
  add("box", SceneShape::Type::kBox, {1.0, 0.0, 0.3}).half_size = {0.4, 0.2, 0.3};
  add("ball", SceneShape::Type::kSphere, {0.0, 2.0, 0.5}).radius = 0.5;
  SceneShape& leaning = add("leaning", SceneShape::Type::kBox, {-1.0, 0.0, 0.4});
  leaning.half_size = {0.1, 0.3, 0.4};
  leaning.body_from_shape.rotation = Eigen::AngleAxisd(0.3, Vector3d::UnitY());
  return scene;
}

TEST(ChangedScene, HeightsScaleAboutTheFloor) {
  Scene scene = room();
  for (SceneBody& body : scene.bodies) scale_static_body({1.0, 1.0, 1.2}, body);
  const SceneWorld before = world_of(room()), after = world_of(scene);
  EXPECT_EQ(scene.bodies[0].shapes[0].type, SceneShape::Type::kBox);
  for (const Vector3d& above : {Vector3d(1.1, 0.1, 3.0), Vector3d(0.1, 2.1, 3.0),
                                Vector3d(-1.0, 0.1, 3.0), Vector3d(-0.9, 0.0, 3.0)}) {
    const double height = before.ground_below(0, above);
    ASSERT_GT(height, 0.3);
    // Round shapes become meshes with 32 sides, which the grid interpolates.
    EXPECT_NEAR(after.ground_below(0, above), 1.2 * height, 0.01) << above.transpose();
  }
}

TEST(ChangedScene, UniformScalingKeepsTheShapes) {
  Scene scene = room();
  for (SceneBody& body : scene.bodies) scale_static_body(Vector3d::Constant(1.5), body);
  const SceneWorld before = world_of(room()), after = world_of(scene);
  EXPECT_EQ(scene.bodies[1].shapes[0].type, SceneShape::Type::kSphere);
  for (std::size_t body = 0; body < 3; ++body) {
    const Vector3d at(0.3, 0.9, 1.1);
    EXPECT_NEAR(after.distance(0, body, 1.5 * at).distance,
                1.5 * before.distance(0, body, at).distance, 1e-9);
  }
}

TEST(ChangedScene, ResizedObjectsStayOnTheirSupportSurface) {
  Scene scene = room();
  scene.bodies[0].moves = true;
  scene.bodies[0].mass = 2.0;
  const SceneWorld before = world_of(scene);
  ObjectTrack track{"box", {}, {scene.bodies[0].world_from_body}};
  change_objects({0.1, 0.0, 0.0}, 1.5, before.fields, scene, std::span(&track, 1));
  EXPECT_NEAR(track.world_from_body[0].translation.z(), 0.45, 1e-12);
  EXPECT_NEAR(track.world_from_body[0].translation.x(), 1.1, 1e-12);
  EXPECT_NEAR(scene.bodies[0].shapes[0].half_size.z(), 0.45, 1e-12);
  EXPECT_NEAR(scene.bodies[0].mass, 2.0 * 3.375, 1e-9);
  EXPECT_NEAR(scene.bodies[1].world_from_body.translation.z(), 0.5, 1e-12);
}

// A moving box whose frame lies at `origin` in the box, and is turned by a quarter.
struct FramedBox {
  explicit FramedBox(const Vector3d& origin)
      : box_from_body{Eigen::Quaterniond(Eigen::AngleAxisd(kQuarter, Vector3d::UnitZ())), origin} {
    SceneBody& body = scene.bodies.emplace_back();
    body.name = "box";
    body.moves = true;
    SceneShape& shape = body.shapes.emplace_back();
    shape.half_size = {0.4, 0.2, 0.3};
    shape.body_from_shape = box_from_body.inverse();
    body.world_from_body = world_from_box * box_from_body;
  }

  static constexpr double kQuarter = 1.5707963267948966;
  Pose box_from_body;
  Pose world_from_box{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(0.6, 0.0, 0.8))),
                      {2.0, -1.0, 0.5}};
  Scene scene;
};

TEST(ChangedScene, FramesOfObjectsDoNotMatter) {
  for (const Vector3d& origin : {Vector3d(0.0, 0.0, 0.0), Vector3d(0.3, -0.2, 0.1)}) {
    const FramedBox framed(origin);
    const Pose& before = framed.scene.bodies[0].world_from_body;
    SceneWorld placed = world_of(framed.scene);
    placed.fixed = {0};  // A track moves the box.
    const SceneWorld world = scaled_world(placed, 0.75);
    const Pose scaled = world.clip.pose(0, 0) * framed.box_from_body.inverse();
    EXPECT_LT((scaled.translation.head<2>() - Vector2d(1.5, -0.75)).norm(), 1e-12);
    EXPECT_LT((world.clip.scene->bodies[0].world_from_body.translation -
               world.clip.pose(0, 0).translation)
                  .norm(),
              1e-12);

    Scene larger = framed.scene;
    ObjectTrack track;
    track.body = "box";
    track.world_from_body = {before};
    const SceneWorld first = world_of(framed.scene);
    change_objects({0.1, 0.0, 0.0}, 1.5, first.fields, larger, std::span(&track, 1));
    const Vector3d centre =
        track.world_from_body[0] * larger.bodies[0].shapes[0].body_from_shape.translation;
    EXPECT_LT((centre.head<2>() - Vector2d(2.1, -1.0)).norm(), 1e-12);
  }
}

TEST(ChangedScene, FramesOfObjectsDoNotMatterBetweenFrames) {
  // The box turns and moves; at 60 fps, every second frame is between two of the track.
  std::vector<Pose> found;
  for (const Vector3d& origin : {Vector3d(0.0, 0.0, 0.0), Vector3d(1.0, -0.5, 0.3)}) {
    const FramedBox framed(origin);
    ObjectTrack track;
    track.rate = FrameRate{30, 1};
    for (int frame = 0; frame < 5; ++frame) {
      const Pose box{Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * frame, Vector3d::UnitZ())),
                     {0.01 * frame * frame, 0.1 * frame, 0.5}};
      track.world_from_body.push_back(box * framed.box_from_body);
    }
    const auto clip =
        value_of(place_scene(std::make_shared<const Scene>(framed.scene), std::span(&track, 1),
                             {FrameRate{30, 1}, 5, 0, FrameRate{60, 1}, 9}));
    found.push_back(clip.pose(3, 0) * framed.box_from_body.inverse());
  }
  EXPECT_LT((found[0].translation - found[1].translation).norm(), 1e-12);
}

TEST(ChangedScene, ConvertsFilesWithOtherAxes) {
  Scene scene;
  SceneBody& body = scene.bodies.emplace_back();
  body.name = "box";
  body.world_from_body.translation = {100.0, 30.0, -50.0};  // Centimetres, Y up.
  SceneShape& shape = body.shapes.emplace_back();
  shape.half_size = {40.0, 30.0, 20.0};
  Eigen::Matrix3d world_from_file;
  world_from_file << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  bring_to_world(world_from_file, 0.01, scene, {});
  const SceneWorld world = world_of(scene);
  EXPECT_NEAR(world.ground_below(0, {1.0, 0.5, 2.0}), 0.6, 1e-3);
  EXPECT_NEAR(world.distance(0, 0, {1.0, 0.5, 0.3}).distance, -0.2, 1e-9);
}

TEST(SceneWorldTest, BodiesAroundAPointAreNotBelowIt) {
  const SceneWorld world = world_of(room());
  EXPECT_NEAR(world.ground_below(0, {1.0, 0.0, 0.61}), 0.6, 1e-3);
  EXPECT_EQ(world.ground_below(0, {1.0, 0.0, 0.4}), 0.0);
  EXPECT_EQ(world.ground_below(0, {5.0, 5.0, 0.4}), 0.0);
}

TEST(SceneWorldTest, IsBeyondImpliesALargerDistance) {
  const SceneWorld world = scaled_world(world_of(room()), 0.7);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0), limit(-0.05, 1.0);
  int beyond = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d at(coordinate(random), coordinate(random), coordinate(random));
    const double distance = limit(random);
    for (std::size_t body = 0; body < world.body_count(); ++body) {
      if (!world.is_beyond(0, body, at, distance)) continue;
      ++beyond;
      EXPECT_GT(world.distance(0, body, at).distance, distance);
    }
  }
  EXPECT_GT(beyond, 1000);
}

}  // namespace
}  // namespace retarget
