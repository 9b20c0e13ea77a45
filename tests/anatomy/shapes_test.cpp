#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "retarget/shape_distance.h"
#include "robot/anatomy/bare_robot.h"
#include "robot/anatomy/shapes.h"
#include "support/box_obj.h"
#include "support/humanoids.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

namespace fs = std::filesystem;

std::string write_below(const TemporaryFolder& folder, const std::string& name,
                        const std::string& text) {
  fs::create_directories((folder.path() / name).parent_path());
  return folder.write(name, text);
}

// The tiny humanoid with meshes in millimetres for feet and thighs, and a missing mesh file for the
// head.
std::string with_mesh_feet() {
  std::string text = tiny_humanoid(true);
  const std::string box = "<geom type=\"box\" pos=\"0.03 0 -0.04\" size=\"0.08 0.03 0.01\"/>";
  for (std::size_t at = text.find(box); at != std::string::npos; at = text.find(box)) {
    text.replace(at, box.size(), "<geom type=\"mesh\" mesh=\"foot\"/>");
  }
  text.insert(text.find("<worldbody>"),
              "<asset><mesh name=\"foot\" file=\"foot.obj\" scale=\".001 .001 .001\"/>"
              "<mesh name=\"head\" file=\"head.stl\"/></asset>");
  const std::string torso = "<body name=\"torso\" pos=\"0 0 0.05\">";
  text.insert(text.find(torso) + torso.size(), "<geom type=\"mesh\" mesh=\"head\"/>");
  text.replace(text.find("<compiler"), 9, "<compiler meshdir=\"assets\"");
  return text;
}

CompletedRobot completed_from(const std::string& model) {
  const auto bare = value_of(load_robot_files(model));
  return value_of(complete_bare_robot(*bare, model));
}

void expect_mesh_soles(const Robot& robot) {
  ASSERT_EQ(robot.profile().soles.size(), 2U);
  for (const Sole& sole : robot.profile().soles) {
    double heel = INFINITY, toe = -INFINITY;
    for (const Eigen::Vector3d& point : sole.points) {
      EXPECT_NEAR(point.z(), -0.07, 1e-6);
      heel = std::min(heel, point.x());
      toe = std::max(toe, point.x());
    }
    EXPECT_NEAR(heel, -0.06, 1e-6);
    EXPECT_NEAR(toe, 0.13, 1e-6);
  }
}

// The head's file is missing, which MuJoCo would report as an error of the whole model.
TEST(MeshPoints, ProvideSolesIfOtherMeshesAreMissing) {
  const TemporaryFolder folder;
  write_below(folder, "assets/foot.obj", box_obj({-60, -35, -70}, {130, 35, -20}));
  const CompletedRobot completed = completed_from(folder.write("robot.xml", with_mesh_feet()));
  EXPECT_FALSE(completed.guessed);
  EXPECT_EQ(completed.note, "from mesh vertices");
  expect_mesh_soles(*completed.robot);
}

TEST(MeshPoints, NameMissingFiles) {
  const TemporaryFolder folder;
  const CompletedRobot completed = completed_from(folder.write("robot.xml", with_mesh_feet()));
  EXPECT_TRUE(completed.guessed);
  EXPECT_THAT(completed.note, HasSubstr("estimated from the limbs' lengths (3 of 3 mesh files of "
                                        "the model are missing or unreadable, such as"));
  EXPECT_THAT(completed.note, HasSubstr("foot.obj"));
}

TEST(MeshPoints, FollowPackagesAndCollada) {
  const TemporaryFolder folder;
  // A foot in centimetres, positioned by its node.
  std::string positions;
  for (const char* x : {"-1", "1"}) {
    for (const char* y : {"-1", "1"}) {
      for (const char* z : {"-1", "1"}) positions += std::string(x) + " " + y + " " + z + " ";
    }
  }
  write_below(folder, "tiny/meshes/foot.dae",
              "<COLLADA><asset><unit meter=\"0.01\"/><up_axis>Y_UP</up_axis></asset>"
              "<library_geometries><geometry id=\"g\"><mesh>"
              "<source id=\"p\"><float_array count=\"24\">" +
                  positions +
                  "</float_array></source>"
                  "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
                  "<polylist count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
                  "<input semantic=\"NORMAL\" source=\"#n\" offset=\"1\"/>"
                  "<vcount>4</vcount><p>0 0 1 0 3 0 2 0</p></polylist>"
                  "<triangles><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
                  "<p>0 4 6 1 5 7</p></triangles></mesh></geometry></library_geometries>"
                  "<library_visual_scenes><visual_scene><node><translate>3.5 0 -4.5</translate>"
                  "<node><scale>9.5 3.5 2.5</scale><instance_geometry url=\"#g\"/></node>"
                  "</node></visual_scene></library_visual_scenes></COLLADA>");
  std::string text = with_mesh_feet();
  text.replace(text.find("foot.obj\" scale=\".001 .001 .001\""), 32,
               "package://tiny/meshes/foot.dae\"");
  text.replace(text.find(" meshdir=\"assets\""), 17, "");
  // MJCF has no packages: the same code reads names of URDF form.
  const std::string model = write_below(folder, "tiny/robot.xml", text);
  const CompletedRobot completed = completed_from(model);
  EXPECT_FALSE(completed.guessed) << completed.note;
  expect_mesh_soles(*completed.robot);
}

// The shape excludes parts that the thigh touches next to its motor; a single shape around the mesh
// would include them.
TEST(MeshPoints, GiveBodiesTheirOwnShapes) {
  const TemporaryFolder folder;
  write_below(folder, "assets/foot.obj", box_obj({-60, -35, -70}, {130, 35, -20}));
  write_below(folder, "assets/head.stl",
              "solid\nfacet\nvertex 0 0 0\nvertex 0 .1 .3\nvertex .1 0 .3\nendfacet\n");
  std::string text = with_mesh_feet();
  for (const char* side : {"left", "right"}) {
    const std::string thigh = std::string("<body name=\"") + side + "_thigh\">";
    text.insert(text.find(thigh) + thigh.size(), "<geom type=\"mesh\" mesh=\"thigh\"/>");
  }
  text.insert(text.find("<mesh name=\"head\""), "<mesh name=\"thigh\" file=\"thigh.obj\"/>");
  write_below(folder, "assets/thigh.obj", box_obj({-0.03, -0.03, -0.2}, {0.03, 0.03, 0.0}));
  const CompletedRobot completed = completed_from(folder.write("robot.xml", text));
  const int thigh = completed.robot->find_body("left_thigh").value();
  int count = 0;
  for (const CollisionShape& shape : completed.robot->collision_shapes()) {
    if (shape.body != thigh) continue;
    ++count;
    EXPECT_NE(shape.type, CollisionShape::Type::kBox);
    for (const Eigen::Vector3d& point : core_points(shape)) {
      EXPECT_GT(point.z(), -0.2);
      EXPECT_LT(point.z(), 0.0);
      EXPECT_LT(point.head<2>().norm(), 0.03);
    }
    EXPECT_LT(shape.radius, 0.05);
  }
  EXPECT_GE(count, 1);
}

// Names of the bodies with estimated shapes; the model has no meshes.
std::set<std::string> estimated_bodies(const std::string& text) {
  const auto robot = robot_from_text(text);
  const auto limbs = find_limbs(*robot, "");
  EXPECT_TRUE(limbs.has_value());
  std::set<std::string> names;
  if (!limbs) return names;
  for (const RoughShape& rough : find_shapes(*robot, *limbs, {}).shapes) {
    if (rough.source == ShapeSource::kEstimated) {
      names.insert(robot->bodies()[rough.shape.body].name);
    }
  }
  return names;
}

std::string with_child(std::string text, const std::string& body, const std::string& geom) {
  const std::string key = "<body name=\"" + body + "\"";
  text.insert(text.find('>', text.find(key)) + 1,
              "<body name=\"" + body + "_shape\">" + geom + "</body>");
  return text;
}

TEST(FindShapes, CountShapesOfFixedBodies) {
  using ::testing::Contains;
  using ::testing::Not;
  const std::string text = tiny_humanoid(true);
  ASSERT_THAT(estimated_bodies(text), Contains("left_thigh"));
  ASSERT_THAT(estimated_bodies(text), Contains("left_forearm"));
  const std::string capsule =
      "<geom type=\"capsule\" fromto=\"0 0 -0.03 0 0 -0.16\" size=\"0.03\"/>";
  const auto thigh = estimated_bodies(with_child(text, "left_thigh", capsule));
  EXPECT_THAT(thigh, Not(Contains("left_thigh")));
  EXPECT_THAT(thigh, Contains("right_thigh"));
  // The hand is fixed to the forearm but does not cover it.
  EXPECT_THAT(estimated_bodies(with_child(text, "left_hand", "<geom size=\"0.03\"/>")),
              Contains("left_forearm"));
}

TEST(FindShapes, SolesOfFixedBodiesAreTheFeet) {
  const std::string box = "<geom type=\"box\" pos=\"0.03 0 -0.04\" size=\"0.08 0.03 0.01\"/>";
  std::string text = tiny_humanoid(true);
  std::size_t at = 0;
  for (const std::string side : {"left", "right"}) {
    at = text.find(box, at);
    ASSERT_NE(at, std::string::npos);
    const std::string sole = "<body name=\"" + side + "_sole\">" + box + "</body>";
    text.replace(at, box.size(), sole);
    at += sole.size();
  }
  EXPECT_THAT(estimated_bodies(text), ::testing::Not(::testing::Contains("left_foot")));
}

// The tiny humanoid with other knees and feet.
std::string with_feet(const std::string& knee_range, const std::string& feet) {
  std::string text = tiny_humanoid(true);
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{"range=\"0 2.4\"", "range=\"" + knee_range + "\""},
        {"<geom type=\"box\" pos=\"0.03 0 -0.04\" size=\"0.08 0.03 0.01\"/>", feet}}) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  }
  return text;
}

struct FoundFeet {
  RobotAnatomy limbs;
  RobotShapes shapes;
};

FoundFeet find_feet(const std::string& text) {
  const auto robot = robot_from_text(text);
  auto limbs = value_of(find_limbs(*robot, ""));
  RobotShapes shapes = find_shapes(*robot, limbs, {});
  return {std::move(limbs), std::move(shapes)};
}

const std::string kBoxFoot = "<geom type=\"box\" pos=\"0.03 0 -0.04\" size=\"0.08 0.03 0.01\"/>";
const std::string kBallFoot =
    "<geom pos=\"-0.05 0.03 -0.04\" size=\"0.01\"/><geom pos=\"-0.05 -0.03 -0.04\" size=\"0.01\"/>"
    "<geom pos=\"0.11 0.03 -0.04\" size=\"0.01\"/><geom pos=\"0.11 -0.03 -0.04\" size=\"0.01\"/>";

// Knees that cannot straighten tilt the feet in the zero configuration.
TEST(FindShapes, SolesOfTiltedFeetAreTheirUndersides) {
  for (const std::string& feet : {kBoxFoot, kBallFoot}) {
    for (const std::string bend : {"0.05", "0.3", "0.6"}) {
      const auto [limbs, shapes] = find_feet(with_feet(bend + " 2.4", feet));
      EXPECT_EQ(shapes.sole_source, ShapeSource::kModel) << bend;
      EXPECT_THAT(limbs.notes, ::testing::Contains(HasSubstr("degrees off level")));
      ASSERT_EQ(shapes.soles.size(), 2U);
      for (const Sole& sole : shapes.soles) {
        ASSERT_EQ(sole.points.size(), 4U);
        for (std::size_t i = 0; i < 4; ++i) {
          EXPECT_NEAR(sole.points[i].z(), -0.05, 1e-9);
          EXPECT_NEAR(sole.points[i].x(), i < 2 ? -0.05 : 0.11, 1e-9);
        }
      }
      EXPECT_NEAR(shapes.ankle_height, 0.05, 1e-9);
      EXPECT_TRUE(
          limbs.legs[0].end->body_from_bone.col(1).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
      EXPECT_TRUE(
          limbs.legs[0].end->body_from_bone.col(0).isApprox(Eigen::Vector3d::UnitX(), 1e-9));
    }
  }
  const auto [level, shapes] = find_feet(with_feet("0 2.4", kBoxFoot));
  EXPECT_THAT(level.notes, ::testing::Not(::testing::Contains(HasSubstr("off level"))));
}

// Three balls of different height support a foot in several poses.
TEST(FindShapes, EstimatedSolesOfKnownFeetSayWhy) {
  const auto [limbs, shapes] =
      find_feet(with_feet("0 2.4",
                          "<geom pos=\"0.1 0 -0.04\" size=\"0.04\"/>"
                          "<geom pos=\"-0.05 0.03 -0.04\" size=\"0.01\"/>"
                          "<geom pos=\"-0.05 -0.03 -0.04\" size=\"0.01\"/>"));
  EXPECT_EQ(shapes.sole_source, ShapeSource::kEstimated);
  EXPECT_THAT(shapes.sole_note, HasSubstr("touch the floor only in a point or a line"));
  EXPECT_TRUE(limbs.legs[0].end->body_from_bone.col(1).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
}

// A visual mesh whose collision shape is on a body fixed to its own.
TEST(MeshPoints, AreNotFittedWhereShapesOfFixedBodiesAre) {
  const TemporaryFolder folder;
  write_below(folder, "assets/foot.obj", box_obj({-60, -35, -70}, {130, 35, -20}));
  write_below(folder, "assets/thigh.obj", box_obj({-0.03, -0.03, -0.2}, {0.03, 0.03, 0.0}));
  std::string text = with_mesh_feet();
  text.insert(text.find("<mesh name=\"head\""), "<mesh name=\"thigh\" file=\"thigh.obj\"/>");
  for (const char* side : {"left", "right"}) {
    const std::string thigh = std::string("<body name=\"") + side + "_thigh\">";
    text.insert(text.find(thigh) + thigh.size(),
                "<geom type=\"mesh\" mesh=\"thigh\" contype=\"0\" conaffinity=\"0\"/>");
  }
  text = with_child(text, "left_thigh",
                    "<geom type=\"box\" pos=\"0 0 -0.1\" size=\"0.03 0.03 0.1\"/>");
  text = with_child(text, "right_thigh", "<geom pos=\"0 0 -0.18\" size=\"0.02\"/>");
  const CompletedRobot completed = completed_from(folder.write("robot.xml", text));
  const auto count = [&](const char* body) {
    return std::ranges::count(completed.robot->collision_shapes(),
                              completed.robot->find_body(body).value(), &CollisionShape::body);
  };
  EXPECT_EQ(count("left_thigh"), 0);
  EXPECT_GT(count("right_thigh"), 0);
}

}  // namespace
}  // namespace retarget
