// Loading MJCF: models that compile without their files, and the messages of rejected ones.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <thread>
#include <vector>

#include "retarget/load_robot.h"
#include "robot/model/mujoco_messages.h"
#include "support/shared_data.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

// The error of loading a robot from this text.
Error error_of(const std::string& mjcf) {
  const TemporaryFolder folder;
  const auto robot = load_robot_files(folder.write("robot.xml", mjcf));
  EXPECT_FALSE(robot.has_value());
  if (robot) return {};
  EXPECT_EQ(robot.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(robot.error().message, Not(HasSubstr("\n")));
  return robot.error();
}

// A model of these lines within worldbody, which begin in line 3.
std::string world(const std::string& lines) {
  return "<mujoco>\n<worldbody>\n" + lines + "\n</worldbody>\n</mujoco>\n";
}

constexpr const char* kFloatingBall = R"(<body name="base"><freejoint/><geom size="0.1"/></body>)";

// MuJoCo warns about a mass matrix that cannot be factorised.
const std::string kSingular = world(
    R"(<body name="base"><freejoint/><geom size="0.1"/>
       <body><joint armature="-1"/><geom size="0.1"/></body></body>)");

TEST(LoadModelTest, MeshesAndOtherFilesAreNotNeeded) {
  const auto robot = robot_from_text(R"(
<mujoco>
  <compiler meshdir="nowhere" inertiafromgeom="true" fusestatic="true"/>
  <asset>
    <mesh name="mesh" file="mesh.stl"/>
    <hfield name="hills" file="hills.png" size="1 1 1 1"/>
    <texture name="texture" type="2d" file="texture.png"/>
    <material name="material" texture="texture"/>
    <skin file="skin.skn"/>
  </asset>
  <default>
    <geom type="mesh" mesh="mesh" material="material"/>
    <default class="plain"><geom type="sphere" size="0.1"/></default>
  </default>
  <worldbody>
    <geom type="hfield" hfield="hills"/>
    <body name="base">
      <freejoint/>
      <geom/>
      <site name="site" material="material"/>
      <body name="arm">
        <joint name="elbow" range="-1 1"/>
        <geom name="arm_mesh"/>
        <geom type="capsule" size="0.1 0.2" mesh="mesh"/>
        <geom name="arm_sphere" mesh="mesh" type="sphere" size="0.1"/>
        <body name="marker" pos="0 0 1"/>
      </body>
    </body>
  </worldbody>
  <contact>
    <pair geom1="arm_mesh" geom2="arm_sphere"/>
    <exclude body1="base" body2="arm"/>
  </contact>
  <tendon><fixed name="tendon"><joint joint="elbow" coef="1"/></fixed></tendon>
  <equality><joint joint1="elbow"/></equality>
  <actuator><motor joint="elbow"/><motor tendon="tendon"/></actuator>
  <sensor><framepos objtype="geom" objname="arm_mesh"/><jointpos joint="elbow"/></sensor>
  <keyframe><key qpos="0 0 0 1 0 0 0 0"/></keyframe>
</mujoco>)");
  EXPECT_THAT(robot->body_names(), ElementsAre("world", "base", "arm", "marker"));
  EXPECT_THAT(robot->joint_names(), ElementsAre("elbow"));
}

TEST(LoadModelTest, FollowsIncludes) {
  const TemporaryFolder folder;
  folder.write("part.xml", "<mujocoinclude>" + std::string(kFloatingBall) + "</mujocoinclude>");
  const auto robot =
      value_of(load_robot_files(folder.write("robot.xml", world("<include file=\"part.xml\"/>"))));
  EXPECT_EQ(robot->name(), "robot");
}

TEST(LoadModelTest, ReferenceModelsLoadWithoutTheirMeshes) {
  const auto shared = shared_folder();
  if (!shared) GTEST_SKIP() << kNoSharedFolder;
  int loaded = 0;
  for (const auto& entry : fs::directory_iterator(*shared / "reference" / "robots")) {
    if (!entry.is_directory()) continue;
    for (const auto& file : fs::directory_iterator(entry.path())) {
      if (file.path().extension() != ".xml" || file.path().filename() == "ground.xml") continue;
      const auto robot = load_robot_files(file.path().string());
      if (entry.path().filename() == "galaxea_r1pro") {
        ASSERT_FALSE(robot.has_value());
        EXPECT_THAT(robot.error().message, HasSubstr("no free joint"));
        continue;
      }
      EXPECT_TRUE(robot.has_value()) << describe(robot.error());
      if (!robot) continue;
      EXPECT_GE((*robot)->joints().size(), 19U) << file.path();
      EXPECT_THAT((*robot)->warnings(), IsEmpty()) << file.path();
      ++loaded;
    }
  }
  EXPECT_GE(loaded, 17);
}

TEST(LoadModelTest, RejectsFilesThatAreNotModels) {
  const TemporaryFolder folder;
  const auto error = [](const std::string& path) { return load_robot_files(path).error(); };
  EXPECT_THAT(error(folder.path().string()).message, HasSubstr("directory"));
  EXPECT_THAT(error((folder.path() / "none.xml").string()).message, HasSubstr("No such file"));
  EXPECT_THAT(error("-").message, HasSubstr("standard input"));
  EXPECT_THAT(error_of("").message, HasSubstr("empty"));
  EXPECT_THAT(error_of(" \n\t").message, HasSubstr("empty"));
  EXPECT_THAT(error_of("version https://git-lfs").message, HasSubstr("not XML"));
  EXPECT_THAT(error_of("<html></html>").message, HasSubstr("cannot load the model"));
}

TEST(LoadModelTest, SyntaxErrorsHaveALine) {
  const Error mismatch = error_of(world("<body>"));
  EXPECT_THAT(mismatch.message,
              AllOf(HasSubstr("not well-formed XML"), HasSubstr("no matching closing tag")));
  EXPECT_GT(mismatch.location.line, 0U);

  const Error attribute = error_of(world("<body/>\n<body foo=\"1\"/>"));
  EXPECT_EQ(attribute.location.line, 4U);
  EXPECT_THAT(attribute.message, AllOf(HasSubstr("unrecognized attribute: 'foo'"),
                                       HasSubstr("'body'"), Not(HasSubstr("line"))));

  const Error number = error_of(world("<body pos=\"0 0 x\"/>"));
  EXPECT_EQ(number.location.line, 3U);
  EXPECT_THAT(number.message, HasSubstr("pos"));

  EXPECT_THAT(error_of(world("<include file=\"none.xml\"/>")).message, HasSubstr("none.xml"));
}

TEST(LoadModelTest, ModelErrorsHaveALine) {
  const Error twice = error_of(world("<body name=\"a\"/>\n<body name=\"a\"/>"));
  EXPECT_EQ(twice.location.line, 4U);
  EXPECT_THAT(twice.message, HasSubstr("repeated name 'a'"));

  const Error axis = error_of(
      world("<body><freejoint/><geom size=\"1\"/>\n"
            "<body><joint name=\"knee\" axis=\"0 0 0\"/><geom size=\"1\"/></body></body>"));
  EXPECT_EQ(axis.location.line, 4U);
  EXPECT_THAT(axis.message, AllOf(HasSubstr("axis"), HasSubstr("knee")));
}

TEST(LoadModelTest, RepeatedNamesInUrdfAreNamed) {
  const Error twice = error_of(
      "<robot name=\"r\">\n<link name=\"a\"/>\n<link name=\"b\"/>\n<link name=\"b\"/>\n"
      "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>\n</robot>");
  EXPECT_EQ(twice.location.line, 4U);
  EXPECT_THAT(twice.message, HasSubstr("repeated name 'b': two elements of kind link"));

  const std::string joint =
      "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>";
  const Error joints = error_of(
      "<robot name=\"r\">\n<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n" + joint +
      "\n<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child "
      "link=\"c\"/></joint>\n</robot>");
  EXPECT_EQ(joints.location.line, 4U);
  EXPECT_THAT(joints.message, HasSubstr("repeated name 'j': two elements of kind joint"));
}

TEST(LoadModelTest, TheNameOfTheWorldIsReserved) {
  const Error error = error_of(world("<body name=\"world\"><freejoint/><geom size=\"1\"/></body>"));
  EXPECT_THAT(error.message, HasSubstr("the name 'world' of a body is reserved"));
  EXPECT_THAT(error.message, Not(HasSubstr("two elements")));
}

TEST(LoadModelTest, RejectsEndlessNesting) {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<body>";
  EXPECT_THAT(error_of(world(deep)).message, HasSubstr("nested too deeply"));
}

TEST(LoadModelTest, RejectsNonFiniteNumbers) {
  const auto with = [](const std::string& inner) {
    return world("<body><freejoint/><geom size=\"1\"/><body name=\"arm\" " + inner +
                 "<geom size=\"1\"/></body></body>");
  };
  EXPECT_THAT(error_of(with("pos=\"nan 0 0\">")).message, HasSubstr("\"arm\""));
  EXPECT_THAT(error_of(with("pos=\"0 inf 0\">")).message, HasSubstr("\"arm\""));
  EXPECT_THAT(error_of(with("><joint name=\"elbow\" ref=\"nan\"/>")).message,
              HasSubstr("\"elbow\""));
  EXPECT_THAT(error_of(with("><joint name=\"elbow\" range=\"0 inf\"/>")).message,
              HasSubstr("elbow"));
  EXPECT_THAT(error_of(with("><joint name=\"elbow\" range=\"nan 1\"/>")).message,
              HasSubstr("elbow"));
  EXPECT_THAT(error_of(with("><joint/><geom size=\"1\" mass=\"inf\"/>")).message,
              HasSubstr("\"arm\""));
  for (const char* inertial : {R"(pos="0 0 0" mass="inf" diaginertia="1 1 1")",
                               R"(pos="0 0 0" mass="nan" diaginertia="1 1 1")",
                               R"(pos="0 0 0" mass="1" diaginertia="1 inf 1")",
                               R"(pos="0 0 0" mass="1" fullinertia="1 1 1 0 nan 0")",
                               R"(pos="0 inf 0" mass="1" diaginertia="1 1 1")",
                               R"(pos="nan 0 0" mass="1" diaginertia="1 1 1")"}) {
    EXPECT_THAT(error_of(with(std::string("><inertial ") + inertial + "/>")).message,
                HasSubstr("\"arm\""))
        << inertial;
  }
}

TEST(LoadModelTest, LimitsJointsWithARangeOfASinglePosition) {
  const auto limits = [](const std::string& joint) {
    const auto robot =
        robot_from_text(world("<body><freejoint/><geom size=\"1\"/><body><joint name=\"elbow\" " +
                              joint + "/><geom size=\"1\"/></body></body>"));
    return std::array{robot->model_limits().lower[0], robot->model_limits().upper[0]};
  };
  EXPECT_EQ(limits("type=\"slide\" range=\"0.25 0.25\""), (std::array{0.25, 0.25}));
  EXPECT_EQ(limits("type=\"slide\" range=\"0 0\""), (std::array<double, 2>{-INFINITY, INFINITY}));
  EXPECT_EQ(limits("type=\"slide\" limited=\"false\" range=\"0.25 0.25\""),
            (std::array<double, 2>{-INFINITY, INFINITY}));
  const TemporaryFolder folder;
  const std::string link =
      "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/></inertial></link>";
  for (const char* name : {"robot.urdf", "robot.xml"}) {
    const auto urdf = value_of(load_robot_files(
        folder.write(
            name, "<robot name=\"r\"><link name=\"a\">" + link + "<link name=\"b\">" + link +
                      "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/>"
                      "<limit lower=\"0.3\" upper=\"0.3\"/></joint></robot>"),
        {}, RobotBase::kFixed));
    EXPECT_EQ(urdf->model_limits().upper[0], 0.3) << name;
    EXPECT_THAT(urdf->warnings(), IsEmpty()) << name;
  }
}

TEST(LoadModelTest, RejectsReversedRanges) {
  const auto with = [](const std::string& joint) {
    return world("<body><freejoint/><geom size=\"1\"/><body>" + joint +
                 "<geom size=\"1\"/></body></body>");
  };
  EXPECT_THAT(error_of(with("<joint name=\"knee\" range=\"1 0\"/>")).message,
              AllOf(HasSubstr("\"knee\""), HasSubstr("range")));
  EXPECT_THAT(error_of(with("<joint name=\"knee\" limited=\"true\" range=\"1 0\"/>")).message,
              AllOf(HasSubstr("'knee'"), HasSubstr("range")));
}

TEST(LoadModelTest, RobotMustHaveOneFreeJointFirst) {
  EXPECT_THAT(error_of(world("<body><joint/><geom size=\"1\"/></body>")).message,
              HasSubstr("no free joint"));
  EXPECT_THAT(error_of(world("")).message, HasSubstr("no free joint"));
  EXPECT_THAT(
      error_of(world(std::string(kFloatingBall) + "<body><freejoint/><geom size=\"1\"/></body>"))
          .message,
      HasSubstr("2 free joints"));
  EXPECT_THAT(error_of(world("<body><joint name=\"door\"/><geom size=\"1\"/></body>" +
                             std::string(kFloatingBall)))
                  .message,
              AllOf(HasSubstr("first joint"), HasSubstr("\"door\"")));
}

TEST(LoadModelTest, RejectsBallJoints) {
  const Error error =
      error_of(world("<body><freejoint/><geom size=\"1\"/><body><joint name=\"hip\" type=\"ball\"/>"
                     "<geom size=\"1\"/></body></body>"));
  EXPECT_THAT(error.message, AllOf(HasSubstr("ball joint \"hip\""), HasSubstr("not supported")));
}

TEST(LoadModelTest, WrongInertiasDoNotMoveBodies) {
  robot_from_text(world(R"(<body><freejoint/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 10"/></body>)"));
}

TEST(LoadModelTest, RecognisesUrdf) {
  const TemporaryFolder folder;
  const auto robot = load_robot_files(folder.write("robot.urdf", R"(<robot name="r">
    <link name="base"/><link name="arm"><visual><geometry><mesh filename="arm.stl"/></geometry>
    </visual></link>
    <joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)"));
  ASSERT_FALSE(robot.has_value());
  EXPECT_THAT(robot.error().hint, HasSubstr("URDF"));
}

TEST(LoadModelTest, DeduplicatesWarnings) {
  const auto robot = robot_from_text(kSingular);
  ASSERT_EQ(robot->warnings().size(), 1U);
  EXPECT_THAT(robot->warnings().front(), HasSubstr("singular"));
  EXPECT_THAT(robot_from_text(world(kFloatingBall))->warnings(), IsEmpty());
}

// MuJoCo's defaults print, write MUJOCO_LOG.TXT into the working folder and exit.
TEST(LoadModelTest, NothingIsPrintedOrLeftBehind) {
  const TemporaryFolder folder;
  const fs::path old_folder = fs::current_path();
  fs::current_path(folder.path());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  robot_from_text(kSingular);
  error_of("<mujoco>");
  error_of(world("<body name=\"a\"/><body name=\"a\"/>"));
  const std::string printed =
      testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  fs::current_path(old_folder);
  EXPECT_EQ(printed, "");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(LoadModelTest, GuardCapturesMessagesAndRestoresHandlers) {
  const auto error_before = mju_user_error;
  const auto warning_before = mju_user_warning;
  {
    const MessageGuard guard;
    mju_warning("odd\nindeed");
    mju_error("%s", "wrong\n");
    EXPECT_THAT(guard.warnings(), ElementsAre("odd; indeed"));
    EXPECT_THAT(guard.errors(), ElementsAre("wrong"));
  }
  EXPECT_EQ(mju_user_error, error_before);
  EXPECT_EQ(mju_user_warning, warning_before);
}

TEST(LoadModelTest, ThreadsCanLoadConcurrently) {
  const TemporaryFolder folder;
  const std::string good = folder.write("good.xml", kTwoArms);
  const std::string bad = folder.write("bad.xml", world("<body foo=\"1\"/>"));
  std::vector<std::thread> threads;
  std::vector<int> faults(4, 0);
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 25; ++i) {
        if (!load_robot_files(good).has_value()) ++faults[t];
        const auto failed = load_robot_files(bad);
        if (failed.has_value() || failed.error().location.line != 3) ++faults[t];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(faults, ElementsAre(0, 0, 0, 0));
}

}  // namespace
}  // namespace retarget
