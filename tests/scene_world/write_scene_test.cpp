#include "retarget/write_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <memory>
#include <sstream>

#include "retarget/load_robot.h"
#include "retarget/motion_io.h"
#include "retarget/scene.h"
#include "retarget/so3.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using Type = SceneShape::Type;

// A closed tetrahedron, away from the origin of its frame.
std::shared_ptr<const TriangleMesh> tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{1.0, 0.0, 0.0}, {1.4, 0.0, 0.0}, {1.0, 0.3, 0.0}, {1.0, 0.0, 0.2}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return std::make_shared<const TriangleMesh>(std::move(mesh));
}

SceneBody one_shape(const std::string& name, SceneShape shape) {
  SceneBody body;
  body.name = name;
  body.shapes = {std::move(shape)};
  return body;
}

// A step that has the name of a robot link, a moving crate and a moving mesh.
SceneClip made_scene(int frames) {
  Scene scene;
  SceneShape box;
  box.half_size = {0.3, 0.2, 0.1};
  scene.bodies.push_back(one_shape("pelvis", box));
  scene.bodies.back().world_from_body.translation = {0.5, 0.0, 0.1};
  scene.bodies.push_back(one_shape("crate", box));
  scene.bodies.back().moves = true;
  scene.bodies.back().mass = 3.0;
  SceneShape mesh;
  mesh.type = Type::kMesh;
  mesh.mesh = tetrahedron();
  mesh.body_from_shape.translation = {0.0, 0.1, 0.2};
  mesh.body_from_shape.rotation = exp_so3(Vector3d(0.0, 0.0, 0.5));
  scene.bodies.push_back(one_shape("wedge", mesh));
  scene.bodies.back().moves = true;
  SceneClip clip;
  clip.rate = {30, 1};
  clip.frame_count = frames;
  for (int frame = 0; frame < frames; ++frame) {
    clip.world_from_body.push_back(scene.bodies[0].world_from_body);
    clip.world_from_body.push_back(
        {exp_so3(Vector3d(0.1, 0.2, 0.1 * frame)), Vector3d(1.0, 0.02 * frame, 0.7)});
    clip.world_from_body.push_back({exp_so3(Vector3d(0.0, 0.3, 0.0)), Vector3d(-1.0, 0.0, 0.5)});
  }
  clip.scene = std::make_shared<const Scene>(std::move(scene));
  return clip;
}

RobotClip made_motion(int frames) {
  const std::string folder = std::string(RETARGET_SOURCE_DIR) + "/robots/unitree_g1/";
  const auto robot = load_robot_files(folder + "model.xml", folder + "robot.json");
  RobotClip clip(*robot, {30, 1}, frames);
  for (int frame = 0; frame < frames; ++frame) {
    clip.qpos(frame)[0] = 0.1 + 0.01 * frame;
    clip.qpos(frame)[10] = 0.123456;
  }
  return clip;
}

struct LoadedMjcf {
  ModelPtr model;
  std::unique_ptr<mjData, void (*)(mjData*)> data{nullptr, mj_deleteData};
};

LoadedMjcf load_mjcf(const std::string& text) {
  const TemporaryFolder folder;
  std::array<char, 1000> error{};
  LoadedMjcf loaded;
  loaded.model.reset(mj_loadXML(folder.write("scene.xml", text).c_str(), nullptr, error.data(),
                                static_cast<int>(error.size())));
  EXPECT_TRUE(loaded.model) << error.data();
  if (loaded.model) loaded.data.reset(mj_makeData(loaded.model.get()));
  return loaded;
}

TEST(WriteScene, MjcfHasRobotAndScene) {
  const RobotClip motion = made_motion(3);
  const SceneClip scene = made_scene(3);
  const auto text = value_of(format_scene_mjcf(motion, scene));
  EXPECT_EQ(text.find("file="), std::string::npos);
  const LoadedMjcf loaded = load_mjcf(text);
  ASSERT_TRUE(loaded.data);
  mjModel* model = loaded.model.get();
  mjData* data = loaded.data.get();
  const int robot = motion.robot().configuration_size();
  ASSERT_EQ(model->nq, robot + 14);
  ASSERT_EQ(model->nkey, 2);
  mj_resetDataKeyframe(model, data, 0);
  for (int i = 0; i < robot; ++i) EXPECT_NEAR(data->qpos[i], motion.qpos(0)[i], 1e-6) << i;
  mj_forward(model, data);
  const auto expect_at = [&](const char* name, const Pose& pose) {
    const int id = mj_name2id(model, mjOBJ_BODY, name);
    ASSERT_GE(id, 0) << name;
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(data->xpos[3 * id + i], pose.translation[i], 1e-6) << name;
      EXPECT_NEAR(data->xquat[4 * id + 1 + i], pose.rotation.vec()[i], 1e-6) << name;
    }
  };
  expect_at("pelvis_2", scene.pose(0, 0));
  expect_at("crate", scene.pose(0, 1));
  expect_at("wedge", scene.pose(0, 2));
  // All bodies of the robot are where forward kinematics places them.
  std::vector<Pose> poses(motion.robot().bodies().size());
  forward_kinematics(motion.robot(), motion.qpos(0), poses);
  for (std::size_t b = 1; b < poses.size(); ++b) {
    expect_at(motion.robot().bodies()[b].name.c_str(), poses[b]);
  }
}

// MuJoCo rejects limits to a single position.
TEST(WriteScene, MjcfHasJointsThatAreLimitedToOnePosition) {
  const TemporaryFolder folder;
  const auto robot = value_of(load_robot_files(folder.write(
      "robot.xml",
      "<mujoco><worldbody><body><freejoint/><geom size=\"1\"/><body><joint name=\"held\" "
      "type=\"slide\" range=\"0.25 0.25\"/><geom "
      "size=\"1\"/></body></body></worldbody></mujoco>")));
  const auto text = value_of(format_scene_mjcf(RobotClip(robot, {30, 1}, 3), made_scene(3)));
  const LoadedMjcf loaded = load_mjcf(text);
  ASSERT_TRUE(loaded.model);
  const int joint = mj_name2id(loaded.model.get(), mjOBJ_JOINT, "held");
  ASSERT_GE(joint, 0);
  EXPECT_NE(loaded.model->jnt_limited[joint], 0);
  EXPECT_NEAR(loaded.model->jnt_range[2 * joint], 0.25, 1e-5);
}

TEST(WriteScene, MjcfHasMassesFloorAndMeshesInPlace) {
  const RobotClip motion = made_motion(3);
  const SceneClip scene = made_scene(3);
  const auto text = value_of(format_scene_mjcf(motion, scene));
  const LoadedMjcf loaded = load_mjcf(text);
  ASSERT_TRUE(loaded.data);
  const mjModel& model = *loaded.model;
  const int crate = mj_name2id(&model, mjOBJ_BODY, "crate");
  EXPECT_NEAR(model.body_mass[crate], 3.0, 1e-4);
  const double volume = 0.4 * 0.3 * 0.2 / 6.0;
  const int wedge = mj_name2id(&model, mjOBJ_BODY, "wedge");
  EXPECT_NEAR(model.body_mass[wedge], kObjectDensity * volume, 1e-4);
  double mass = 0.0, expected = 0.0;
  for (int b = 1; b < motion.robot().model()->nbody; ++b) {
    mass += model.body_mass[b];
    expected += motion.robot().model()->body_mass[b];
  }
  EXPECT_NEAR(mass, expected, 1e-3);
  EXPECT_EQ(std::count(model.geom_type, model.geom_type + model.ngeom, mjGEOM_PLANE), 1);
  mj_resetDataKeyframe(&model, loaded.data.get(), 0);
  mj_forward(&model, loaded.data.get());
  const int geom = model.body_geomadr[wedge], mesh = model.geom_dataid[geom];
  ASSERT_EQ(model.mesh_vertnum[mesh], 4);
  const SceneShape& shape = scene.scene->bodies[2].shapes[0];
  for (int v = 0; v < 4; ++v) {
    const float* local = model.mesh_vert + 3 * (model.mesh_vertadr[mesh] + v);
    const double in_geom[3] = {local[0], local[1], local[2]};
    double found[3];
    mju_mulMatVec3(found, loaded.data->geom_xmat + 9 * geom, in_geom);
    const Vector3d wanted = scene.pose(0, 2) * (shape.body_from_shape *
                                                shape.mesh->vertices[static_cast<std::size_t>(v)]);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(found[i] + loaded.data->geom_xpos[3 * geom + i], wanted[i], 1e-5) << v;
    }
  }
}

TEST(WriteScene, JsonReadsBack) {
  const SceneClip scene = made_scene(3);
  const TemporaryFolder folder;
  const auto read = value_of(load_scene(folder.write("scene.json", format_scene_json(scene))));
  ASSERT_EQ(read.bodies.size(), 3U);
  for (std::size_t b = 0; b < 3; ++b) {
    const SceneBody &found = read.bodies[b], &wanted = scene.scene->bodies[b];
    EXPECT_EQ(found.name, wanted.name);
    EXPECT_EQ(found.moves, wanted.moves);
    EXPECT_EQ(found.mass, wanted.mass);
    EXPECT_EQ(found.world_from_body.translation, scene.pose(0, b).translation);
    EXPECT_LT((found.world_from_body.rotation.coeffs() - scene.pose(0, b).rotation.coeffs()).norm(),
              1e-12);
    ASSERT_EQ(found.shapes.size(), 1U);
    EXPECT_EQ(found.shapes[0].type, wanted.shapes[0].type);
    EXPECT_EQ(found.shapes[0].half_size, wanted.shapes[0].half_size);
  }
  const auto original = tetrahedron();
  const TriangleMesh& mesh = *read.bodies[2].shapes[0].mesh;
  EXPECT_EQ(mesh.triangles.size(), 4U);
  EXPECT_THAT(mesh.vertices, ::testing::UnorderedElementsAreArray(original->vertices));
}

// Volume inside the triangles of an OBJ, by the divergence theorem.
double volume_of(const std::string& obj) {
  std::istringstream lines(obj);
  std::vector<Vector3d> vertices;
  double volume = 0.0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vector3d v;
      words >> v.x() >> v.y() >> v.z();
      vertices.push_back(v);
    } else if (kind == "f") {
      std::array<std::size_t, 3> corners{};
      for (std::size_t& corner : corners) words >> corner;
      volume +=
          vertices[corners[0] - 1].dot(vertices[corners[1] - 1].cross(vertices[corners[2] - 1])) /
          6.0;
    }
  }
  return volume;
}

TEST(WriteScene, ObjHasClosedStaticBodies) {
  constexpr double kPi = 3.14159265358979;
  SceneShape shape;
  shape.radius = 0.5;
  shape.half_length = 0.7;
  shape.half_size = {0.1, 0.2, 0.3};
  shape.body_from_shape.translation = {3.0, 1.0, 2.0};
  const std::vector<std::pair<Type, double>> cases = {
      {Type::kBox, 0.2 * 0.4 * 0.6},
      {Type::kSphere, 4.0 / 3.0 * kPi * 0.125},
      {Type::kCapsule, 4.0 / 3.0 * kPi * 0.125 + kPi * 0.25 * 1.4},
      {Type::kCylinder, kPi * 0.25 * 1.4}};
  for (const auto& [type, volume] : cases) {
    shape.type = type;
    Scene scene;
    scene.bodies.push_back(one_shape("thing", shape));
    scene.bodies.push_back(one_shape("moving", shape));
    scene.bodies.back().moves = true;
    SceneClip clip;
    clip.scene = std::make_shared<const Scene>(scene);
    const std::string obj = format_scene_obj(clip);
    EXPECT_THAT(obj, HasSubstr("o thing\n"));
    EXPECT_EQ(obj.find("moving"), std::string::npos);
    EXPECT_NEAR(volume_of(obj) / volume, 1.0, 0.02) << static_cast<int>(type);
  }
}

TEST(WriteScene, TracksOfObjectsReadBackFromTrackingFiles) {
  const RobotClip motion = made_motion(31);
  WriteMotionOptions options;
  options.scene = made_scene(31);
  options.labels.emplace();
  options.labels->frame_count = 31;
  options.labels->touches = {{"left_hand", "left_wrist_yaw_link", "crate", 10, 21}};
  const TemporaryFolder folder;
  for (const MotionFormat format :
       {MotionFormat::kNpzMjlab, MotionFormat::kNpzBeyondMimic, MotionFormat::kNpzHolosoma}) {
    const auto bytes = value_of(format_robot_motion(motion, format, options));
    const std::string file = folder.write("motion.npz", bytes);
    const auto track = value_of(load_object_track("crate=" + file));
    EXPECT_EQ(track.rate, (FrameRate{50, 1}));
    ASSERT_EQ(track.world_from_body.size(), 50U);
    // Sample 25 is frame 15.
    const Pose& wanted = options.scene->pose(15, 1);
    EXPECT_LT((track.world_from_body[25].translation - wanted.translation).norm(), 1e-6);
    EXPECT_LT(log_so3(track.world_from_body[25].rotation * wanted.rotation.conjugate()).norm(),
              1e-6);
    const auto neither = load_object_track(file);
    ASSERT_FALSE(neither);
    EXPECT_THAT(neither.error().message, HasSubstr("crate"));
    // The robot's motion still exists.
    const auto read = value_of(load_robot_motion(file, motion.shared_robot()));
    EXPECT_EQ(read.format, format);
  }
}

TEST(WriteScene, RejectsOtherExtensions) {
  const auto refused = format_scene("scene.usd", made_motion(1), made_scene(1));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
}

}  // namespace
}  // namespace retarget
