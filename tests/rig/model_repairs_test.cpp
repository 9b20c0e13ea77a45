// Models with parts that MuJoCo refuses and that do not affect kinematics: the robot is the same as
// without them, and a note names them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "retarget/rig.h"
#include "support/built_humanoids.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class ModelRepairs : public ::testing::Test {
 protected:
  Result<MadeRobot> make(const std::string& text, const std::string& file = "robot.xml") {
    return make_robot(folder_.write(file, text), "robot");
  }
  // The model becomes the same robot as another one.
  void expect_same(const std::string& text, const std::string& plain, const std::string& note,
                   const std::string& file = "robot.xml") {
    const auto expected = value_of(make(plain, "plain_" + file));
    const auto made = value_of(make(text, file));
    EXPECT_EQ(made.model, expected.model);
    EXPECT_EQ(made.config, expected.config);
    EXPECT_THAT(made.notes, Contains(HasSubstr(note)));
    EXPECT_THAT(made.decisions, HasSubstr(note));
    RobotSources sources;
    sources.model = folder_.write(file, text);
    const auto found = value_of(check_robot(sources));
    std::vector<std::string> notes;
    for (const RobotFinding& finding : found) {
      EXPECT_FALSE(finding.fault) << finding.text;
      notes.push_back(finding.text);
    }
    EXPECT_THAT(notes, Contains(HasSubstr(note)));
  }
  std::string refusal(const std::string& text, const std::string& file = "robot.xml") {
    const auto made = make(text, file);
    EXPECT_FALSE(made);
    return made ? std::string() : made.error().message;
  }

  TemporaryFolder folder_;
};

std::string put(std::string text, const std::string& before, const std::string& what) {
  const std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before;
  return text.insert(at, what);
}

// A small biped with arms as a URDF, below links and joints that represent the world.
std::string urdf(const std::string& world = {}, const std::string& pelvis = {}) {
  std::string links, joints;
  const auto link = [&](const std::string& name, const std::string& more = {}) {
    links += fmt::format(
        "<link name=\"{}\">{}<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" "
        "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n",
        name, more);
  };
  const auto joint = [&](const std::string& parent, const std::string& child, double y, double z,
                         const std::string& axis) {
    link(child);
    joints += fmt::format(
        "<joint name=\"{1}\" type=\"{2}\"><parent link=\"{0}\"/><child link=\"{1}\"/>"
        "<origin xyz=\"0 {3} {4}\"/><axis xyz=\"{5}\"/>"
        "<limit effort=\"9\" velocity=\"7\" lower=\"-2\" upper=\"2\"/></joint>\n",
        parent, child, axis.empty() ? "fixed" : "revolute", y, z, axis.empty() ? "1 0 0" : axis);
  };
  link("pelvis", pelvis);
  for (const std::string side : {"left", "right"}) {
    const double sign = side == "left" ? 1.0 : -1.0;
    joint("pelvis", side + "_hip_pitch", 0.1 * sign, 0, "0 1 0");
    joint(side + "_hip_pitch", side + "_hip_roll", 0, 0, "1 0 0");
    joint(side + "_hip_roll", side + "_knee", 0, -0.2, "0 1 0");
    joint(side + "_knee", side + "_ankle", 0, -0.25, "0 1 0");
    joint("pelvis", side + "_shoulder_pitch", 0.15 * sign, 0.3, "0 1 0");
    joint(side + "_shoulder_pitch", side + "_shoulder_roll", 0, 0, "1 0 0");
    joint(side + "_shoulder_roll", side + "_elbow", 0, -0.18, "0 -1 0");
    joint(side + "_elbow", side + "_hand", 0, -0.15, "");
  }
  return "<robot name=\"r\" xmlns:xacro=\"http://ros.org/wiki/xacro\">" + world + links + joints +
         "</robot>";
}

std::string world_joint(const std::string& type, const std::string& parent,
                        const std::string& child) {
  return fmt::format(
      "<joint name=\"to_{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>"
      "</joint>",
      child, type, parent, child);
}

TEST_F(ModelRepairs, IgnoreXacroLeftovers) {
  const std::string calls =
      "<xacro:property name=\"width\" value=\"${2 * radius}\"/>"
      "<xacro:depth_camera name=\"${prefix}eye\" parent=\"pelvis\"><origin xyz=\"0 0 1\"/>"
      "</xacro:depth_camera>";
  expect_same(urdf(calls, "<xacro:imu rate=\"$(arg rate)\"/>"), urdf(),
              "elements of xacro without a definition are ignored: xacro:property, "
              "xacro:depth_camera, xacro:imu",
              "robot.urdf");
}

TEST_F(ModelRepairs, StillRejectXacroTemplates) {
  const std::string links = "<link name=\"more\"/>";
  for (const std::string& definition : std::vector<std::string>{
           "<xacro:include filename=\"arms.xacro\"/>", "<xacro:macro name=\"imu\"/>",
           "<xacro:if value=\"true\">" + links + "</xacro:if>"}) {
    EXPECT_THAT(refusal(urdf(definition + "<xacro:imu/>"), "robot.urdf"),
                HasSubstr("the file is a template"))
        << definition;
  }
  EXPECT_THAT(refusal(urdf("<link name=\"${side}_tool\"/><xacro:imu/>"), "robot.urdf"),
              HasSubstr("which xacro must substitute"));
}

TEST_F(ModelRepairs, IgnoreUnknownSensors) {
  const std::string plain = plain_humanoid().mjcf();
  const std::string note = "sensors, actuators, cameras and lights are ignored";
  const std::string site = "<site name=\"imu\"/>";
  const std::string pelvis = put(plain, "<freejoint/>", site);
  for (const std::string& sensors : std::vector<std::string>{
           "<sensor><gyro site=\"imu\" rate=\"200\"/></sensor>",
           "<sensor><lidar_2d site=\"imu\"/></sensor>",
           "<actuator><hydraulic joint=\"left_knee\"/></actuator>",
           "<default><motor peak=\"100\"/></default><sensor><gyro site=\"imu\"/></sensor>"}) {
    expect_same(put(pelvis, "<worldbody>", sensors), plain, note);
  }
  expect_same(put(plain, "<freejoint/>", "<sensor type=\"imu\"/>"), plain, note);
  expect_same(put(plain, "<freejoint/>", "<camera name=\"eye\" lens=\"wide\"/>"), plain, note);
  expect_same(put(plain, "<freejoint/>", "<site name=\"imu\" rate=\"200\"/>"), plain,
              "MuJoCo does not know \"rate\" of sites");
}

TEST_F(ModelRepairs, IgnoreUnknownSensorsOfIncludedFiles) {
  const std::string plain = plain_humanoid().mjcf();
  folder_.write("sensors.xml", "<mujoco><sensor><radar/></sensor></mujoco>");
  folder_.write("more.xml", "<mujoco><include file=\"sensors.xml\"/></mujoco>");
  expect_same(put(plain, "<worldbody>", "<include file=\"more.xml\"/>"), plain,
              "cannot read one of them: unrecognized element");
}

TEST_F(ModelRepairs, StillRejectUnknownKinematics) {
  const std::string plain = plain_humanoid().mjcf();
  const std::string sensors = "<sensor><radar/></sensor>";
  EXPECT_THAT(refusal(put(plain, "<freejoint/>", "<joint name=\"a\" helix=\"1\"/>")),
              HasSubstr("unrecognized attribute: 'helix'"));
  EXPECT_THAT(refusal(put(plain, "<freejoint/>", "<screw name=\"a\"/>")),
              HasSubstr("unrecognized element"));
  // The error is the first one of the file, with its line.
  const auto made = make(put(put(plain, "<worldbody>", sensors), "<freejoint/>", "\n<screw/>"));
  ASSERT_FALSE(made);
  EXPECT_GT(made.error().location.line, 0U);
}

TEST_F(ModelRepairs, OmitBodiesThatRepresentTheWorld) {
  const std::string plain = plain_humanoid().mjcf();
  const auto below = [&](const std::string& bodies, const std::string& ends) {
    return put(put(plain, "<body name=\"pelvis\"", bodies), "</worldbody>", ends);
  };
  expect_same(below("<body name=\"world\">", "</body>"), plain,
              "the body \"world\" represents the world");
  expect_same(below("<body name=\"dummy\">", "</body>"), plain,
              "the body \"dummy\" represents the world");
  expect_same(below("<body name=\"world\"><body name=\"dummy\"><site/>", "</body></body>"), plain,
              "the bodies \"world\", \"dummy\" represent the world");
}

TEST_F(ModelRepairs, OmitLinksThatRepresentTheWorld) {
  const std::string note = "represents the world: it has no mass, and is omitted";
  for (const std::string name : {"dummy", "odom"}) {
    const std::string link = "<link name=\"" + name + "\"/>";
    expect_same(urdf(link + world_joint("floating", name, "pelvis")), urdf(),
                "the link \"" + name + "\" " + note, "robot.urdf");
    expect_same(urdf("<link name=\"map\"/>" + link + world_joint("fixed", "map", name) +
                     world_joint("floating", name, "pelvis")),
                urdf(), "the link \"" + name + "\" " + note, "robot.urdf");
  }
  // MuJoCo knows the world by its name, and a dummy that is fixed needs no repair.
  for (const std::string type : {"floating", "fixed"}) {
    const auto made = value_of(
        make(urdf("<link name=\"world\"/>" + world_joint(type, "world", "pelvis")), "robot.urdf"));
    EXPECT_EQ(made.model, make(urdf(), "plain.urdf")->model) << type;
  }
  const auto fixed =
      make(urdf("<link name=\"dummy\"/>" + world_joint("fixed", "dummy", "pelvis")), "robot.urdf");
  EXPECT_TRUE(fixed) << describe(fixed.error());
}

TEST_F(ModelRepairs, RejectAFloatingLinkBelowABodyWithMass) {
  const std::string cart =
      "<link name=\"cart\"><inertial><mass value=\"9\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" "
      "ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>";
  EXPECT_THAT(refusal(urdf(cart + world_joint("floating", "cart", "pelvis")), "robot.urdf"),
              HasSubstr("free joint can only be used on top level"));
}

}  // namespace
}  // namespace retarget
