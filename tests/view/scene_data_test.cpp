#include "view/scene_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "retarget/view.h"
#include "view/page_data.h"

namespace retarget {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::ordered_json;
using Type = SceneShape::Type;

SceneShape shape_of(Type type) {
  SceneShape shape;
  shape.type = type;
  shape.half_size = {0.1, 0.2, 0.3};
  shape.radius = 0.4;
  shape.half_length = 0.5;
  if (type == Type::kMesh) {
    TriangleMesh mesh;
    mesh.vertices = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    shape.mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
  }
  return shape;
}

// A static body with every shape, and a crate that moves along x.
SceneClip room(int frames) {
  Scene scene;
  scene.bodies.resize(2);
  scene.bodies[0].name = "room";
  for (const Type type : {Type::kPlane, Type::kBox, Type::kSphere, Type::kCapsule, Type::kCylinder,
                          Type::kMesh, Type::kMesh}) {
    scene.bodies[0].shapes.push_back(shape_of(type));
  }
  scene.bodies[0].shapes[6].mesh = scene.bodies[0].shapes[5].mesh;
  scene.bodies[1].name = "crate";
  scene.bodies[1].moves = true;
  scene.bodies[1].shapes.push_back(shape_of(Type::kBox));
  SceneClip clip;
  clip.rate = {30, 1};
  clip.frame_count = frames;
  for (int frame = 0; frame < frames; ++frame) {
    clip.world_from_body.push_back({Eigen::Quaterniond::Identity(), {1.0, 2.0, 0.0}});
    clip.world_from_body.push_back({Eigen::Quaterniond::Identity(), {0.01 * frame, 0.0, 0.3}});
  }
  clip.scene = std::make_shared<const Scene>(std::move(scene));
  return clip;
}

TEST(SceneData, HasShapesAndPosesOfEveryBody) {
  TrackPacker packer;
  const Json json = ScenePacker().pack({room(5), std::nullopt, 0.8, {}}, packer).value();
  EXPECT_EQ(json["scale"], 0.8);
  ASSERT_EQ(json["bodies"].size(), 2U);
  const Json& shapes = json["bodies"][0]["shapes"];
  EXPECT_EQ(shapes[0]["plane"], true);
  EXPECT_EQ(shapes[1]["box"], Json({0.1, 0.2, 0.3}));
  EXPECT_EQ(shapes[2]["sphere"], 0.4);
  EXPECT_EQ(shapes[3]["capsule"], Json({0.4, 0.5}));
  EXPECT_EQ(shapes[4]["cylinder"], Json({0.4, 0.5}));
  // Two shapes share one mesh, which is written once.
  EXPECT_EQ(shapes[5]["mesh"], shapes[6]["mesh"]);
  ASSERT_EQ(packer.tracks().size(), 4U);
  const auto& vertices = packer.tracks()[shapes[5]["mesh"]["vertices"].get<std::size_t>()];
  EXPECT_EQ(vertices.frames, 4);
  EXPECT_EQ(vertices.step, kPageMeshStep);
  const Json& world = json["robot"];
  EXPECT_EQ(world["frames"], 5);
  EXPECT_EQ(world["poses"][0], Json({1.0, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0}));
  EXPECT_TRUE(world["poses"][1].is_null());
  const auto& position = packer.tracks()[world["position"].get<std::size_t>()];
  EXPECT_EQ(position.channels, 3);
  EXPECT_EQ(position.frames, 5);
  EXPECT_EQ(packer.tracks()[world["rotation"].get<std::size_t>()].channels, 4);
  EXPECT_FALSE(json.contains("human"));
}

TEST(SceneData, HasTheWorldOfTheHuman) {
  TrackPacker packer;
  const Json json = ScenePacker().pack({room(5), room(7), 0.8, {}}, packer).value();
  EXPECT_EQ(json["human"]["frames"], 7);
  EXPECT_NE(json["human"]["position"], json["robot"]["position"]);
}

TEST(SceneData, RejectsPosesTooFarAway) {
  SceneClip clip = room(3);
  clip.world_from_body.back().translation.x() = 1e9;
  TrackPacker packer;
  const auto packed = ScenePacker().pack({clip, std::nullopt, 1.0, {}}, packer);
  ASSERT_FALSE(packed);
  EXPECT_THAT(packed.error().message, HasSubstr("too far away"));
}

TEST(SceneData, BoundsTheSize) {
  EXPECT_THAT(scene_lines(nullptr), IsEmpty());
  SceneClip clip = room(3);
  EXPECT_THAT(scene_lines(&clip), IsEmpty());
  TriangleMesh large;
  large.vertices.resize(3);
  large.triangles.assign(300001, {0, 1, 2});
  Scene scene = *clip.scene;
  scene.bodies[0].shapes[5].mesh = std::make_shared<const TriangleMesh>(std::move(large));
  clip.scene = std::make_shared<const Scene>(scene);
  ASSERT_EQ(scene_lines(&clip).size(), 1U);
  EXPECT_EQ(scene_lines(&clip)[0].text,
            "omitted from the page: 300005 triangles, at most 300000 fit on a page");
  scene.bodies[0].shapes.assign(20000, shape_of(Type::kBox));
  clip.scene = std::make_shared<const Scene>(scene);
  EXPECT_THAT(scene_excess(clip), HasSubstr("20001 shapes"));
  SceneClip long_clip = room(3);
  long_clip.frame_count = 1000001;
  EXPECT_THAT(scene_excess(long_clip), HasSubstr("1000001 poses of moving bodies"));
}

TEST(SceneData, GroupsContactsByPartAndSurface) {
  ContactLabels labels;
  labels.frame_count = 100;
  labels.touches = {{"left_hand", "palm", "crate", 50, 60},
                    {"left_hand", "palm", "crate", 10, 20},
                    {"left_heel", "foot", "floor", 0, 100},
                    {"seat", "pelvis", "room", 70, 90},
                    {"back", "torso", "room", 95, 100}};
  EXPECT_EQ(page_touches(labels, 80).dump(),
            R"([{"part":"left_hand","surface":"crate","phases":[[10,20],[50,60]]},)"
            R"({"part":"seat","surface":"room","phases":[[70,80]]}])");
}

}  // namespace
}  // namespace retarget
