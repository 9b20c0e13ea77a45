// Robots of URDF files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "retarget/load_robot.h"
#include "retarget/rig.h"
#include "rig/finding_texts.h"
#include "support/box_obj.h"
#include "support/humanoids.h"
#include "support/temporary_folder.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

namespace fs = std::filesystem;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// The notes of `robots check` about a model file.
std::vector<std::string> notes_of(const std::string& model) {
  return finding_texts(check_robot(sources_of_model(model, RETARGET_SOURCE_DIR)), false);
}

// The tiny humanoid as a URDF whose meshes belong to a missing package.
std::string tiny_urdf() {
  std::string links = "<robot name=\"tiny\">";
  std::string joints;
  const auto link = [&](const std::string& name) {
    links += "<link name=\"" + name +
             "\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" "
             "ixz=\"0\" iyz=\"0\"/></inertial><collision><geometry><mesh "
             "filename=\"package://tiny/meshes/" +
             name + ".STL\"/></geometry></collision></link>";
  };
  const auto joint = [&](const std::string& parent, const std::string& child, const std::string& at,
                         const std::string& axis, const std::string& lower,
                         const std::string& upper) {
    link(child);
    const std::string type = axis.empty() ? "fixed" : "revolute";
    joints += "<joint name=\"" + child + "_joint\" type=\"" + type + "\"><parent link=\"" + parent +
              "\"/><child link=\"" + child + "\"/><origin xyz=\"" + at + "\" rpy=\"0 0 0\"/>";
    if (!axis.empty()) {
      joints += "<axis xyz=\"" + axis + "\"/><limit effort=\"10\" velocity=\"7.5\" lower=\"" +
                lower + "\" upper=\"" + upper + "\"/>";
    }
    joints += "</joint>";
  };
  link("base");
  for (const std::string side : {"l", "r"}) {
    const std::string sign = side == "l" ? "" : "-";
    joint("base", side + "_hip_pitch", "0 " + sign + "0.1 0", "0 1 0", "-2", "2");
    joint(side + "_hip_pitch", side + "_hip_roll", "0 0 0", "1 0 0", "-1", "1");
    joint(side + "_hip_roll", side + "_knee", "0 0 -0.2", "0 1 0", "0", "2");
    joint(side + "_knee", side + "_ankle", "0 0 -0.25", "0 1 0", "-1", "1");
    joint("base", side + "_sho_pitch", "0 " + sign + "0.15 0.3", "0 1 0", "-3", "3");
    joint(side + "_sho_pitch", side + "_sho_roll", "0 0 0", "1 0 0", "-3", "3");
    joint(side + "_sho_roll", side + "_elbow", "0 0 -0.18", "0 -1 0", "0", "2");
    joint(side + "_elbow", side + "_hand", "0 0 -0.15", "", "", "");
  }
  return links + joints + "</robot>";
}

TEST(UrdfRobots, VisualsOfAUrdfMayHaveSeveralMaterials) {
  const auto with = [](const std::string& materials, const std::string& more = {}) {
    std::string text = tiny_urdf();
    const std::string place = "<link name=\"l_knee\">";
    text.insert(text.find(place) + place.size(),
                "<visual><geometry><box size=\"0.1 0.1 0.1\"/></geometry>" + materials +
                    "</visual>\n" + more);
    return text;
  };
  const std::string one = "<material name=\"grey\"/>";
  const std::string several =
      one + "<!-- <material> --><material name=\"\">\n<color rgba=\"1 0 0 1\"/>\n</material>" + one;
  const TemporaryFolder folder;
  const auto expected = value_of(make_robot(folder.write("one.urdf", with(one)), "tiny"));
  const auto made = value_of(make_robot(folder.write("several.urdf", with(several)), "tiny"));
  EXPECT_EQ(made.model, expected.model);
  // Errors have the line of the file.
  const auto broken =
      make_robot(folder.write("broken.urdf", with(several, "<inertial/><inertial/>")), "tiny");
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().location.line, 4U);
}

TEST(UrdfRobots, ReadsUrdfWithoutMeshes) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("tiny.urdf", tiny_urdf()), "tiny"));
  EXPECT_THAT(made.notes, Contains(HasSubstr("\"base\" was given one")));
  const auto written = value_of(save_robot(made, folder.path(), false));
  const auto robot = load_robot_in(written);
  EXPECT_EQ(robot->joints().size(), 14U);
  for (std::size_t j = 0; j < robot->joints().size(); ++j) {
    EXPECT_EQ(robot->speed_limit(static_cast<int>(j)), 7.5);
  }
  // The fixed hand is a separate body, the trunk one body.
  EXPECT_TRUE(robot->find_body("l_hand"));
  EXPECT_THAT(made.config, HasSubstr("\"l_hand\": [\"LeftHand\""));
}

// Links without mass above the base do not become the root.
TEST(UrdfRobots, TheBaseOfAUrdfIsItsFirstLinkWithMass) {
  const auto below = [](const std::string& rpy) {
    return replaced(
        tiny_urdf(), "<robot name=\"tiny\">",
        "<robot name=\"tiny\"><link name=\"base_footprint\"/><link name=\"base_link\"/>"
        "<joint name=\"a\" type=\"fixed\"><parent link=\"base_footprint\"/>"
        "<child link=\"base_link\"/></joint>"
        "<joint name=\"b\" type=\"fixed\"><parent link=\"base_link\"/><child link=\"base\"/>"
        "<origin xyz=\"0 0 0.8\" rpy=\"" +
            rpy + "\"/></joint>");
  };
  const TemporaryFolder folder;
  const auto plain = make_robot(folder.write("plain.urdf", tiny_urdf()), "tiny");
  const auto made = make_robot(folder.write("tiny.urdf", below("0 0 1.5")), "tiny");
  ASSERT_TRUE(plain && made) << describe(made.error());
  EXPECT_THAT(made->notes, Contains(HasSubstr("\"base_footprint\", \"base_link\" above the base "
                                              "have no mass")));
  EXPECT_THAT(made->notes, Contains(HasSubstr("the root of motions is \"base\"")));
  EXPECT_EQ(made->model, plain->model);
  EXPECT_EQ(made->config, plain->config);
  // A link that tilts the base gives the robot its upright pose.
  const auto tilted = value_of(make_robot(folder.write("tilted.urdf", below("0.1 0 0")), "tiny"));
  EXPECT_THAT(tilted.notes, Contains(HasSubstr("\"base_link\" was given one")));
}

TEST(UrdfRobots, SuspectsSpeedsInDegrees) {
  const std::string text = replaced(tiny_urdf(), "velocity=\"7.5\"", "velocity=\"430\"");
  const TemporaryFolder folder;
  const std::string model = folder.write("tiny.urdf", text);
  const auto made = value_of(make_robot(model, "tiny"));
  EXPECT_THAT(made.notes, Contains(HasSubstr("looks like degrees per second")));
  EXPECT_THAT(notes_of(model), Contains(HasSubstr("looks like degrees per second")));
}

TEST(UrdfRobots, ChecksKnowTheSpeedLimits) {
  const TemporaryFolder folder;
  const std::string all = tiny_urdf();
  EXPECT_THAT(notes_of(folder.write("all.urdf", all)), Not(Contains(HasSubstr("no speed limit"))));
  std::string text = all;
  const std::string speed = " velocity=\"7.5\"";
  text.erase(text.find(speed), speed.size());
  EXPECT_THAT(notes_of(folder.write("most.urdf", text)),
              Contains(HasSubstr("no speed limit for l_hip_pitch_joint: 20 rad/s is used")));
}

// Simulators show the visual meshes and use primitives for contacts, or nothing.
TEST(UrdfRobots, VisualMeshesMakeSolesAndShapes) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "meshes");
  const std::string links[] = {
      "base",       "l_hip_pitch", "l_hip_roll", "l_knee",      "l_ankle",    "l_sho_pitch",
      "l_sho_roll", "l_elbow",     "l_hand",     "r_hip_pitch", "r_hip_roll", "r_knee",
      "r_ankle",    "r_sho_pitch", "r_sho_roll", "r_elbow",     "r_hand"};
  for (const std::string& link : links) {
    folder.write("meshes/" + link + ".obj", box_obj({-0.06, -0.03, -0.05}, {0.12, 0.03, 0.02}));
  }
  std::string text = replaced(tiny_urdf(), "collision>", "visual>");
  text = replaced(text, "package://tiny/meshes/", "meshes/");
  text = replaced(text, ".STL", ".obj");
  const std::string model = folder.write("tiny.urdf", text);
  const auto made = value_of(make_robot(model, "tiny"));
  EXPECT_THAT(made.summary, Contains(HasSubstr("mesh vertices")));
  EXPECT_THAT(made.profile, HasSubstr("\"soles_estimated\": false"));
  EXPECT_THAT(made.decisions, HasSubstr("fitted to meshes, 0 estimated"));
  EXPECT_THAT(notes_of(model), Contains(HasSubstr("a run uses the soles from mesh vertices")));
  // A link's own contact shapes come first.
  const std::string collision =
      "<collision><origin xyz=\"0 0 -0.07\"/><geometry><box size=\"0.2 0.08 0.02\"/></geometry>"
      "</collision>";
  for (const std::string side : {"l", "r"}) {
    const std::string link = "<link name=\"" + side + "_ankle\">";
    text = replaced(text, link, link + collision);
  }
  const auto with_boxes = value_of(make_robot(folder.write("boxes.urdf", text), "tiny"));
  EXPECT_THAT(with_boxes.summary, Contains(HasSubstr("the model's contact geoms")));
}

TEST(UrdfRobots, JointsOfTheSameNameAreErrors) {
  const TemporaryFolder folder;
  const auto made = make_robot(
      folder.write("tiny.urdf", replaced(tiny_urdf(), "l_knee_joint", "l_ankle_joint")), "tiny");
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message,
              HasSubstr("repeated name 'l_ankle_joint': two elements of kind joint have it"));
}

// Models of users may be in a folder with the name of any robot.
TEST(UrdfRobots, FoldersOfBareModelsDoNotNameARobot) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "unitree_g1");
  const fs::path model = folder.write("unitree_g1/tiny.urdf", tiny_urdf());
  EXPECT_THAT(finding_texts(check_robot(sources_of_model(model, RETARGET_SOURCE_DIR)), true),
              IsEmpty());
  folder.write("unitree_g1/model.xml", tiny_humanoid(true));
  const auto sources =
      value_of(find_robot_sources((folder.path() / "unitree_g1").string(), RETARGET_SOURCE_DIR));
  EXPECT_THAT(finding_texts(check_robot(sources), true), IsEmpty());
}

}  // namespace
}  // namespace retarget
