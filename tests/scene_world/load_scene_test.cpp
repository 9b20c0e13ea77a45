#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>

#include "retarget/scene.h"
#include "retarget/so3.h"
#include "scene/read_scene.h"
#include "scene_world/mesh_bodies.h"
#include "support/shared_data.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using Type = SceneShape::Type;

std::string obj_text(const TriangleMesh& mesh, const Pose& pose = {}, int first = 1) {
  std::ostringstream text;
  text.precision(9);
  for (const Vector3d& vertex : mesh.vertices) text << "v " << (pose * vertex).transpose() << "\n";
  for (const auto& [a, b, c] : mesh.triangles) {
    text << "f " << a + first << " " << b + first << " " << c + first << "\n";
  }
  return text.str();
}

class LoadScene : public ::testing::Test {
 protected:
  Result<Scene> load(const std::string& name, const std::string& text) {
    return load_scene(folder_.write(name, text));
  }
  std::string error_of(const std::string& name, const std::string& text) {
    const auto scene = load(name, text);
    if (scene) return "no error";
    EXPECT_EQ(scene.error().kind, ErrorKind::kInput);
    EXPECT_THAT(scene.error().location.file, HasSubstr(name));
    return describe(scene.error());
  }
  TemporaryFolder folder_;
};

// The bound of 1000 m applies in metres, whatever the unit of the file.
TEST_F(LoadScene, BoundsLengthsInMetres) {
  const std::string box = folder_.write("box.json", R"({"bodies": [
    {"position": [0, 2000, 0], "shapes": [{"type": "box", "size": [3000, 200, 3000]}]}]})");
  const std::string mesh = folder_.write("mesh.obj",
                                         "v 0 0 0\nv 0 5000 0\nv 5000 0 0\nv 0 0 5000\n"
                                         "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
  for (const std::string& file : {box, mesh}) {
    EXPECT_FALSE(load_scene(file));
    const auto scene = load_scene_in_unit(file, 0.001);
    EXPECT_TRUE(scene) << describe(scene.error());
    EXPECT_TRUE(load_scene_in_unit(file, 0.1));
    EXPECT_FALSE(load_scene_in_unit(file, 0.5));
  }
}

TEST_F(LoadScene, ReadsPrimitivesFromJson) {
  const auto scene = value_of(load("room.json", R"({"bodies": [
    {"name": "table", "position": [1, 2, 0], "quaternion": [0, 0, 0, 2], "mass": 12,
     "shapes": [{"type": "box", "size": [1, 0.6, 0.04], "position": [0, 0, 0.7]},
                {"type": "cylinder", "radius": 0.03, "length": 0.7},
                {"type": "capsule", "radius": 0.02, "length": 0.5}]},
    {"moves": true, "shapes": [{"type": "sphere", "radius": 0.1}]},
    {"name": "hill", "shapes": [{"type": "heights", "heights": [[0, 0, 0], [1, 1, 1]], "spacing": 0.5},
                                {"type": "plane", "position": [0, 0, -1]}]},
    {"name": "floor", "shapes": [{"type": "plane"}]}]})"));
  EXPECT_EQ(scene.name, "room.json");
  ASSERT_EQ(scene.bodies.size(), 3U);
  const SceneBody& table = scene.bodies[0];
  EXPECT_EQ(table.mass, 12.0);
  EXPECT_FALSE(table.moves);
  EXPECT_EQ(table.world_from_body.rotation.z(), 1.0);
  ASSERT_EQ(table.shapes.size(), 3U);
  EXPECT_EQ(table.shapes[0].half_size, Vector3d(0.5, 0.3, 0.02));
  EXPECT_EQ(table.shapes[1].half_length, 0.35);
  EXPECT_EQ(table.shapes[2].type, Type::kCapsule);
  EXPECT_EQ(scene.bodies[1].name, "body_1");
  EXPECT_TRUE(scene.bodies[1].moves);
  EXPECT_EQ(scene.find("hill"), 2);
  EXPECT_EQ(scene.find("floor"), -1);
  // A slope of 1 m in 0.5 m.
  const auto field = value_of(make_distance_field(body_of(scene.bodies[2].shapes[0])));
  EXPECT_LT(field.at({0.5, 0.25, 0.4}).distance, 0.0);
  EXPECT_NEAR(field.at({0.5, 0.25, 0.55}).distance, 0.05 / std::sqrt(5.0), 0.002);
}

TEST_F(LoadScene, ReportsAllErrorsOfJson) {
  const std::string error = error_of("bad.json", R"({"boddies": [], "bodies": [
    {"name": "t", "positon": [1, 0, 0], "mass": -1, "quaternion": [0, 0, 0, 0],
     "shapes": [{"type": "bxo"}, {"type": "sphere", "radius": "x"}, {"type": "box", "size": [1, 1e9, 1]},
                {"type": "heights", "heights": [[1, 2], [1]], "spacing": 1}, 5]}, {}]})");
  for (const char* part :
       {"unknown key \"boddies\" (did you mean \"bodies\"?)", "did you mean \"position\"?",
        "\"mass\" must be a positive number", "\"quaternion\" must be", "did you mean \"box\"?",
        "shape 1: \"radius\"", "shape 2: \"size\"", "row 1 of \"heights\"", "shape 4: expected",
        "body 1: \"shapes\""}) {
    EXPECT_THAT(error, HasSubstr(part));
  }
  EXPECT_THAT(error_of("cut.json", "{\"bodies\": [\n"), HasSubstr("cut.json:2"));
  EXPECT_THAT(error_of("list.json", "[]"), HasSubstr("expected a JSON object"));
  EXPECT_THAT(error_of("none.json", "{}"), HasSubstr("\"bodies\" is missing"));
  EXPECT_THAT(error_of("empty.json", "{\"bodies\": []}"), HasSubstr("no shapes"));
  EXPECT_THAT(error_of("floor.json", R"({"bodies": [{"shapes": [{"type": "plane"}]}]})"),
              HasSubstr("only contains a floor"));
}

TEST_F(LoadScene, ReadsMeshesOfJsonNextToIt) {
  folder_.write("cube.obj", obj_text(box_mesh({1, 1, 1})));
  const std::string start = R"({"bodies": [{"shapes": [{"type": "mesh", "file": )";
  const auto scene = value_of(load("a.json", start + R"("cube.obj", "scale": [1, 0.5, 2]}]}]})"));
  EXPECT_LT((scene.bodies[0].shapes[0].half_size - Vector3d(1, 0.5, 2)).norm(), 1e-12);
  EXPECT_THAT(error_of("b.json", start + R"("cub.obj"}]}]})"), HasSubstr("does not exist"));
  // This file exists, but not in the folders of the scene.
  const std::string outside = error_of("c.json", start + R"("/etc/passwd"}]}]})");
  EXPECT_THAT(outside, HasSubstr("outside the folders of the scene"));
  EXPECT_THAT(outside, HasSubstr("copy the mesh"));
  EXPECT_THAT(error_of("d.json", start + R"("/no/such.obj"}]}]})"), HasSubstr("does not exist"));
}

// A wedge with three different sizes, in COLLADA's axes.
std::string collada(const std::string& up_axis, const std::array<Vector3d, 4>& corners) {
  std::ostringstream text;
  text << "<COLLADA><asset><unit meter=\"1\"/>" << up_axis
       << "</asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array>";
  for (const Vector3d& corner : corners) text << corner.transpose() << " ";
  text << "</float_array></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/>"
          "</vertices><triangles><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
          "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>"
          "<library_visual_scenes><visual_scene><node><instance_geometry url=\"#g\"/></node>"
          "</visual_scene></library_visual_scenes></COLLADA>";
  return text.str();
}

TEST_F(LoadScene, RotatesColladaToZUp) {
  // Right, forward and up.
  const std::array<Vector3d, 4> wanted = {Vector3d(0, 0, 0), {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  std::array<Vector3d, 4> x_up, y_up;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d& at = wanted[i];
    x_up[i] = {at.z(), -at.x(), -at.y()};
    y_up[i] = {at.x(), at.z(), -at.y()};
  }
  const auto expect_corners = [&](const Scene& scene) {
    const auto& vertices = scene.bodies[0].shapes[0].mesh->vertices;
    ASSERT_EQ(vertices.size(), 4U);
    for (const Vector3d& at : wanted) EXPECT_EQ(std::ranges::count(vertices, at), 1) << at;
  };
  const auto expect_wanted = [&](const char* name, const std::string& text) {
    folder_.write("mesh.dae", text);
    const auto direct = load(name, text);
    const auto named = load("named.json", R"({"bodies": [{"shapes": [{"type": "mesh",
                                             "file": "mesh.dae"}]}]})");
    for (const auto* scene : {&direct, &named}) {
      ASSERT_TRUE(*scene) << describe(scene->error());
      expect_corners(**scene);
    }
  };
  expect_wanted("z.dae", collada("<up_axis>Z_UP</up_axis>", wanted));
  expect_wanted("x.dae", collada("<up_axis>X_UP</up_axis>", x_up));
  expect_wanted("y.dae", collada("<up_axis> Y_UP </up_axis>", y_up));
  expect_wanted("default.dae", collada("", y_up));
  // Loaders of URDF ignore the up axis.
  folder_.write("mesh.dae", collada("<up_axis>Y_UP</up_axis>", wanted));
  const auto robot = value_of(load("robot.urdf",
                                   R"(<robot name="r"><link name="a"><collision><geometry>
                             <mesh filename="mesh.dae"/></geometry></collision></link></robot>)"));
  expect_corners(robot);
}

TEST_F(LoadScene, RecognisesBoxesInMeshes) {
  const Pose turned{exp_so3({0.2, -0.1, 0.4}), {1, 2, 0.5}};
  const Vector3d half(0.4, 0.3, 0.05);
  // Two boxes, one without a lid, and a tetrahedron.
  const std::string text =
      obj_text(box_mesh(half), turned) + obj_text(box_mesh({0.1, 0.1, 0.1}), {}, 9) +
      obj_text(box_mesh({0.2, 0.2, 0.2}, false), {{1, 0, 0, 0}, {3, 0, 0}}, 17);
  const auto scene = value_of(load("boxes.obj", text));
  ASSERT_EQ(scene.bodies.size(), 1U);
  EXPECT_EQ(scene.bodies[0].name, "boxes");
  const auto& shapes = scene.bodies[0].shapes;
  ASSERT_EQ(shapes.size(), 3U);
  ASSERT_EQ(shapes[0].type, Type::kBox);
  EXPECT_LT((shapes[0].half_size - half).norm(), 1e-6);
  EXPECT_LT((shapes[0].body_from_shape.translation - turned.translation).norm(), 1e-6);
  EXPECT_LT(log_so3(shapes[0].body_from_shape.rotation.conjugate() * turned.rotation).norm(), 1e-5);
  EXPECT_EQ(shapes[1].body_from_shape.rotation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_EQ(shapes[2].type, Type::kMesh);
  EXPECT_EQ(shapes[2].mesh->triangles.size(), 10U);

  TriangleMesh wedge = box_mesh({0.1, 0.1, 0.1});
  wedge.vertices[7].x() -= 0.01;
  const auto mesh = value_of(load("wedge.obj", obj_text(wedge)));
  EXPECT_EQ(mesh.bodies[0].shapes[0].type, Type::kMesh);
}

TEST_F(LoadScene, RejectsInvalidMeshes) {
  EXPECT_THAT(error_of("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("not a finite number"));
  EXPECT_THAT(error_of("huge.obj", "v 0 0 1e30\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), HasSubstr("1000 m"));
  EXPECT_THAT(error_of("flat.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n"), HasSubstr("no area"));
  EXPECT_THAT(error_of("many.stl", "solid"), HasSubstr("no triangles"));
  EXPECT_THAT(error_of("scene.txt", "x"), HasSubstr("must be JSON"));
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (int i = 0; i < 2'000'003; ++i) many += " 1";
  EXPECT_THAT(error_of("more.obj", many), HasSubstr("at most 2000000"));
}

constexpr const char* kModel =
    R"(<mujoco><asset><mesh name="cube" file="cube.obj" scale="0.1 0.2 0.3"/>
  <hfield name="h" nrow="2" ncol="3" size="1 2 0.5 0.1" elevation="0 0 0 1 1 1"/></asset><worldbody>
  <geom type="plane" size="1 1 1"/><geom type="box" size=".1 .2 .3" pos="1 0 .3"/>
  <geom type="sphere" size="1" contype="0" conaffinity="0"/>
  <body name="crate" pos="0 0 1" quat="0 0 0 1"><freejoint/><geom type="mesh" mesh="cube" pos="0 0 .1"/>
    <body name="lid" pos="0 0 1"><joint type="hinge"/><geom type="sphere" size=".1" pos="0 0 1"/></body></body>
  <body pos="2 0 0"><body name="door" pos="0 1 0"><joint type="hinge"/>
    <geom type="capsule" fromto="0 0 0 0 0 1" size=".05"/><geom type="ellipsoid" size=".1 .2 .3"/></body></body>
  <geom type="hfield" hfield="h" pos="0 5 0"/></worldbody></mujoco>)";

TEST_F(LoadScene, ReadsMjcf) {
  folder_.write("cube.obj", obj_text(box_mesh({1, 1, 1})));
  const auto scene = value_of(load("m.xml", kModel));
  ASSERT_EQ(scene.bodies.size(), 3U);
  const SceneBody& world = scene.bodies[0];
  EXPECT_EQ(world.name, "world");
  ASSERT_EQ(world.shapes.size(), 2U);
  EXPECT_EQ(world.shapes[0].half_size, Vector3d(0.1, 0.2, 0.3));
  const auto hill = value_of(make_distance_field(body_of(world.shapes[1])));
  // The middle of a slope from 0 at y = -2 to 0.5 at y = 2, 5 m from the origin.
  EXPECT_NEAR(hill.at({0, 5, 0.25}).distance, 0.0, 1e-4);

  const SceneBody& crate = scene.bodies[1];
  EXPECT_TRUE(crate.moves);
  EXPECT_EQ(crate.world_from_body.translation, Vector3d(0, 0, 1));
  ASSERT_EQ(crate.shapes.size(), 2U);
  EXPECT_EQ(crate.shapes[0].type, Type::kBox);
  EXPECT_LT((crate.shapes[0].half_size - Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
  EXPECT_LT((crate.shapes[0].body_from_shape.translation - Vector3d(0, 0, 0.1)).norm(), 1e-12);
  EXPECT_LT((crate.shapes[1].body_from_shape.translation - Vector3d(0, 0, 2)).norm(), 1e-12);

  const SceneBody& door = scene.bodies[2];
  EXPECT_FALSE(door.moves);
  EXPECT_LT((door.world_from_body.translation - Vector3d(2, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(door.shapes[0].half_length, 0.5, 1e-12);
  EXPECT_EQ(door.shapes[1].type, Type::kMesh);
}

TEST_F(LoadScene, RejectsMjcfThatItCannotLoadCompletely) {
  EXPECT_THAT(error_of("m.xml", kModel), HasSubstr("\"cube.obj\" does not exist"));
  EXPECT_THAT(error_of("part.xml", "<mujocoinclude><body/></mujocoinclude>"),
              HasSubstr("load the model that includes it"));
  EXPECT_THAT(error_of("loop.xml", "<mujoco><include file=\"loop.xml\"/></mujoco>"),
              HasSubstr("loop.xml"));
  EXPECT_THAT(error_of("field.xml", R"(<mujoco><asset><hfield name="h" file="h.png" size="1 1 1 1"/>
      </asset><worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>)"),
              HasSubstr("\"world\" has a geom"));
  EXPECT_THAT(error_of("nan.xml", R"(<mujoco><worldbody><geom size="nan"/></worldbody></mujoco>)"),
              HasSubstr("error"));
  EXPECT_THAT(error_of("text.xml", "hello"), HasSubstr("text.xml"));
  EXPECT_THAT(error_of("other.xml", "<html/>"), HasSubstr("found <html>"));
}

constexpr const char* kUrdf = R"(<robot name="r"><link name="world"/>
  <link name="a"><inertial><mass value="3"/></inertial>
    <collision><origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><geometry><box size="1 2 3"/></geometry></collision>
    <visual><geometry><sphere radius="9"/></geometry></visual></link>
  <link name="b"><collision><geometry><mesh filename="package://p/box_models/cube.obj" scale="2 2 2"/></geometry></collision></link>
  <link name="c"><collision><geometry><cylinder radius="0.1" length="1"/></geometry></collision></link>
  <joint name="j" type="fixed"><parent link="world"/><child link="a"/><origin xyz="1 0 0"/></joint>
  <joint name="k" type="floating"><parent link="a"/><child link="b"/><origin xyz="0 1 0"/></joint>
  <joint name="l" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0 0 1"/></joint></robot>)";

TEST_F(LoadScene, ReadsUrdf) {
  std::filesystem::create_directory(folder_.path() / "box_models");
  folder_.write("box_models/cube.obj", obj_text(box_mesh({1, 1, 1})));
  const auto scene = value_of(load("r.urdf", kUrdf));
  ASSERT_EQ(scene.bodies.size(), 2U);
  EXPECT_EQ(scene.bodies[0].mass, 3.0);
  ASSERT_EQ(scene.bodies[0].shapes.size(), 1U);
  EXPECT_EQ(scene.bodies[0].shapes[0].half_size, Vector3d(0.5, 1, 1.5));
  EXPECT_NEAR(scene.bodies[0].shapes[0].body_from_shape.rotation.z(), std::sqrt(0.5), 1e-12);
  const SceneBody& moving = scene.bodies[1];
  EXPECT_EQ(moving.name, "b");
  EXPECT_TRUE(moving.moves);
  EXPECT_EQ(moving.world_from_body.translation, Vector3d(1, 1, 0));
  ASSERT_EQ(moving.shapes.size(), 2U);
  EXPECT_LT((moving.shapes[0].half_size - Vector3d(2, 2, 2)).norm(), 1e-12);
  EXPECT_EQ(moving.shapes[1].body_from_shape.translation, Vector3d(0, 0, 1));
}

TEST_F(LoadScene, RejectsInvalidUrdf) {
  EXPECT_THAT(error_of("r.urdf", kUrdf), HasSubstr("cube.obj\" does not exist"));
  const auto with = [](const std::string& text) {
    return "<robot name=\"r\"><link name=\"a\"><collision><geometry>" + text +
           "</geometry></collision></link></robot>";
  };
  EXPECT_THAT(error_of("a.urdf", with("<box size=\"1 nan 2\"/>")), HasSubstr("expected 3 numbers"));
  EXPECT_THAT(error_of("b.urdf", with("<box size=\"1 -1 2\"/>")), HasSubstr("\"a\" has a shape"));
  EXPECT_THAT(error_of("c.urdf", with("<cone/>")), HasSubstr("not a supported shape"));
  EXPECT_THAT(error_of("d.urdf", with("")), HasSubstr("has no geometry"));
  EXPECT_THAT(error_of("e.urdf", R"(<robot name="r"><link name="a"/><link name="b"/>
      <joint name="j"><parent link="a"/><child link="b"/></joint>
      <joint name="k"><parent link="b"/><child link="a"/></joint></robot>)"),
              HasSubstr("form a cycle"));
  EXPECT_THAT(error_of("f.urdf", R"(<robot name="r"><link name="b"/>
      <joint name="j"><parent link="a"/><child link="b"/></joint></robot>)"),
              HasSubstr("does not exist"));
}

TEST_F(LoadScene, GivesBodiesDifferentNames) {
  const std::string body = R"({"name": "a", "shapes": [{"type": "sphere", "radius": 1}]})";
  const auto scene =
      value_of(load("a.json", "{\"bodies\": [" + body + "," + body + ", {\"name\": \"a_2\"," +
                                  body.substr(body.find("\"shapes")) + "]}"));
  std::set<std::string> names;
  for (const SceneBody& each : scene.bodies) names.insert(each.name);
  EXPECT_EQ(names, (std::set<std::string>{"a", "a_2", "a_3"}));
}

TEST(LoadSharedScenes, FindsTheBoxesOfAClimb) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  const auto scene = load_scene((*shared / "data/formats/climb_seq_0_boxes.obj").string());
  if (!scene) GTEST_SKIP() << describe(scene.error());
  ASSERT_EQ(scene->bodies[0].shapes.size(), 3U);
  for (const SceneShape& shape : scene->bodies[0].shapes) EXPECT_EQ(shape.type, Type::kBox);
}

}  // namespace
}  // namespace retarget
