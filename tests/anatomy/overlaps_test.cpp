#include "robot/anatomy/overlaps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "robot/anatomy/bare_robot.h"
#include "robot/anatomy/limbs.h"
#include "support/humanoids.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Names = std::set<std::pair<std::string, std::string>>;
using Poses = std::vector<std::vector<double>>;

void add_geom(std::string& text, const std::string& body, const std::string& geom) {
  const std::size_t at = text.find("<body name=\"" + body + "\"");
  ASSERT_NE(at, std::string::npos) << body;
  text.insert(text.find('>', at) + 1, geom);
}

Names names_of(const Robot& robot, const std::vector<ModelOverlap>& overlaps) {
  Names names;
  for (const ModelOverlap& each : overlaps) {
    names.emplace(robot.bodies()[each.a].name, robot.bodies()[each.b].name);
  }
  return names;
}

std::vector<ModelOverlap> overlaps_of(const Robot& robot) {
  return find_allowed_contacts(robot, find_limbs(robot, "").value(), {},
                               Poses{reference_configuration(robot)})
      .overlaps;
}

// Thighs with boxes thicker than the gap between the hips.
std::string with_thick_thighs() {
  std::string text = tiny_humanoid(true);
  for (const std::string side : {"left", "right"}) {
    add_geom(text, side + "_thigh",
             "<geom type=\"box\" pos=\"0 0 -0.08\" size=\"0.05 0.12 0.07\"/>");
  }
  return text;
}

TEST(ModelOverlaps, FindsOverlappingThighs) {
  const auto robot = robot_from_text(with_thick_thighs());
  const auto overlaps = overlaps_of(*robot);
  ASSERT_EQ(names_of(*robot, overlaps), (Names{{"left_thigh", "right_thigh"}}));
  // Each box is 0.12 thick, 0.1 from the middle.
  EXPECT_NEAR(overlaps[0].depth, 0.04, 1e-9);
  EXPECT_GT(overlaps[0].share, 0.1);
  EXPECT_LT(overlaps[0].share, 1.0);
  EXPECT_THAT(overlap_text(*robot, overlaps[0]),
              HasSubstr("\"left_thigh\" and \"right_thigh\" overlap by 4.0 cm at rest and in "));
}

// A shell around all neighbours is found without any pose.
TEST(ModelOverlaps, FindsPairsThatOverlapInNearlyAllPoses) {
  std::string text = tiny_humanoid(true);
  add_geom(text, "torso", "<geom type=\"box\" pos=\"0 0 0.2\" size=\"0.3 0.4 0.3\"/>");
  for (const std::string side : {"left", "right"}) {
    add_geom(text, side + "_upper_arm",
             "<geom type=\"capsule\" fromto=\"0 0 0 0 0 -0.18\" size=\"0.04\"/>");
  }
  const auto robot = robot_from_text(text);
  const auto overlaps =
      find_allowed_contacts(*robot, find_limbs(*robot, "").value(), {}, Poses{}).overlaps;
  EXPECT_EQ(names_of(*robot, overlaps),
            (Names{{"torso", "left_upper_arm"}, {"torso", "right_upper_arm"}}));
  for (const ModelOverlap& each : overlaps) {
    EXPECT_EQ(each.depth, 0.0);
    EXPECT_GT(each.share, 0.9);
  }
}

// Hands against the thighs separate as soon as an arm moves, so an overlap is a fault of the
// motion.
TEST(ModelOverlaps, IgnoresHandsNextToTheThighs) {
  std::string text = tiny_humanoid(true);
  for (const std::string side : {"left", "right"}) {
    add_geom(text, side + "_thigh",
             "<geom type=\"capsule\" fromto=\"0 0 0 0 0 -0.2\" size=\"0.05\"/>");
    add_geom(text, side + "_hand", "<geom size=\"0.05\"/>");
  }
  const auto robot = robot_from_text(text);
  EXPECT_THAT(names_of(*robot, overlaps_of(*robot)), IsEmpty());
}

// Boxes are separate along an axis of one of them, or along the normal of an edge of each.
bool boxes_touch(const Pose& a, const Pose& b, const Eigen::Vector3d& half) {
  const Eigen::Matrix3d ra = a.rotation.toRotationMatrix(), rb = b.rotation.toRotationMatrix();
  const Eigen::Vector3d between = b.translation - a.translation;
  double gap = -INFINITY;
  const auto try_axis = [&](const Eigen::Vector3d& direction) {
    if (direction.norm() < 1e-9) return;
    const Eigen::Vector3d axis = direction.normalized();
    const double reach =
        (ra.transpose() * axis).cwiseAbs().dot(half) + (rb.transpose() * axis).cwiseAbs().dot(half);
    gap = std::max(gap, std::abs(between.dot(axis)) - reach);
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(ra.col(i));
    try_axis(rb.col(i));
    for (int j = 0; j < 3; ++j) try_axis(ra.col(i).cross(rb.col(j)));
  }
  return gap < -1e-3;
}

// Compares with many more poses from another distribution, and another box test.
TEST(ModelOverlaps, ShareMatchesRandomPoses) {
  const auto robot = robot_from_text(with_thick_thighs());
  const double share = overlaps_of(*robot).at(0).share;
  unsigned state = 12345;
  const auto next = [&] {
    state = state * 1664525U + 1013904223U;
    return (state >> 8U) / 16777216.0;
  };
  const Pose down{Eigen::Quaterniond::Identity(), {0, 0, -0.08}};
  constexpr int kPoses = 20000;
  int touching = 0;
  std::vector<Pose> world(robot->bodies().size());
  std::vector<double> qpos = robot->zero_configuration();
  for (int i = 0; i < kPoses; ++i) {
    for (std::size_t j = 0; j < robot->joints().size(); ++j) {
      const double lower = robot->model_limits().lower[j], upper = robot->model_limits().upper[j];
      qpos[robot->joints()[j].qpos_address] = lower + next() * (upper - lower);
    }
    forward_kinematics(*robot, qpos, world);
    if (boxes_touch(world[robot->find_body("left_thigh").value()] * down,
                    world[robot->find_body("right_thigh").value()] * down, {0.05, 0.12, 0.07})) {
      ++touching;
    }
  }
  EXPECT_NEAR(share, static_cast<double>(touching) / kPoses, 0.02);
}

// Shapes of the left and the right side that differ by a centimetre.
TEST(ModelOverlaps, IncludeTheMirrorImage) {
  std::string text = tiny_humanoid(true);
  add_geom(text, "torso", "<geom type=\"box\" pos=\"0 0 0.2\" size=\"0.05 0.1 0.1\"/>");
  add_geom(text, "left_upper_arm",
           "<geom type=\"box\" pos=\"0 -0.022 -0.08\" size=\"0.03 0.03 0.03\"/>");
  add_geom(text, "right_upper_arm",
           "<geom type=\"box\" pos=\"0 0.012 -0.08\" size=\"0.03 0.03 0.03\"/>");
  const auto named = robot_from_text(text);
  for (const auto& robot : {named, robot_from_text(scramble_names(text))}) {
    const auto overlaps = overlaps_of(*robot);
    ASSERT_EQ(names_of(*named, overlaps),
              (Names{{"torso", "left_upper_arm"}, {"torso", "right_upper_arm"}}));
    EXPECT_GT(overlaps[0].depth, 0.0);
    EXPECT_EQ(overlaps[1].depth, 0.0);
  }
}

// A shape on a separate body that is fixed to a body.
void add_fixed_geom(std::string& text, const std::string& body, const std::string& geom) {
  add_geom(text, body, "<body name=\"" + body + "_shape\">" + geom + "</body>");
}

TEST(ModelOverlaps, MirrorBodiesThatHoldTheShapes) {
  std::string text = tiny_humanoid(true);
  add_geom(text, "torso", "<geom type=\"box\" pos=\"0 0 0.2\" size=\"0.05 0.1 0.1\"/>");
  add_fixed_geom(text, "left_upper_arm",
                 "<geom type=\"box\" pos=\"0 -0.022 -0.08\" size=\"0.03 0.03 0.03\"/>");
  add_fixed_geom(text, "right_upper_arm",
                 "<geom type=\"box\" pos=\"0 0.012 -0.08\" size=\"0.03 0.03 0.03\"/>");
  const auto robot = robot_from_text(text);
  EXPECT_EQ(names_of(*robot, overlaps_of(*robot)),
            (Names{{"torso", "left_upper_arm_shape"}, {"torso", "right_upper_arm_shape"}}));
}

TEST(AllowedContacts, IncludeShapesFixedToNeighbours) {
  std::string text = tiny_humanoid(true);
  add_fixed_geom(text, "torso", "<geom size=\"0.02\"/>");
  add_fixed_geom(text, "left_shoulder_roll", "<geom size=\"0.02\"/>");
  add_fixed_geom(text, "left_upper_arm", "<geom size=\"0.02\"/>");
  const auto robot = robot_from_text(text);
  const auto allowed =
      find_allowed_contacts(*robot, find_limbs(*robot, "").value(), {}, Poses{}).pairs;
  const auto pair = [&](const char* a, const char* b) {
    return std::pair(robot->find_body(a).value(), robot->find_body(b).value());
  };
  EXPECT_THAT(allowed, Contains(pair("torso", "left_shoulder_roll")));
  EXPECT_THAT(allowed, Contains(pair("torso_shape", "left_shoulder_roll_shape")));
  // Three joints apart.
  EXPECT_THAT(allowed, Not(Contains(pair("torso_shape", "left_upper_arm_shape"))));
  // The torso itself has no shape.
  EXPECT_THAT(allowed, Not(Contains(pair("torso", "left_shoulder_roll_shape"))));
}

TEST(AllowedContacts, UseTheExclusionsOfTheModel) {
  const TemporaryFolder folder;
  std::string text = with_thick_thighs();
  text.insert(text.find("</mujoco>"),
              "<contact><exclude body1=\"left_thigh\" body2=\"right_thigh\"/>"
              "<exclude body1=\"left_hand\" body2=\"pelvis\"/></contact>");
  const std::string model = folder.write("robot.xml", text);
  const auto bare = value_of(load_robot_files(model));
  const auto completed = value_of(complete_bare_robot(*bare, model));
  // The model excludes the pair, so there is nothing to report.
  EXPECT_THAT(completed.overlaps, IsEmpty());
  const auto pair = [&](const char* a, const char* b) {
    return std::pair(bare->find_body(a).value(), bare->find_body(b).value());
  };
  const auto& allowed = completed.robot->profile().allowed_self_contact;
  EXPECT_THAT(allowed, Contains(pair("left_thigh", "right_thigh")));
  EXPECT_THAT(allowed, Contains(pair("left_hand", "pelvis")));
  EXPECT_THAT(allowed, Not(Contains(pair("right_hand", "pelvis"))));
}

TEST(AllowedContacts, AreNamedForABareModel) {
  const TemporaryFolder folder;
  const std::string model = folder.write("robot.xml", with_thick_thighs());
  const auto bare = value_of(load_robot_files(model));
  const auto completed = value_of(complete_bare_robot(*bare, model));
  EXPECT_THAT(completed.overlaps, ElementsAre(HasSubstr("\"left_thigh\" and \"right_thigh\"")));
  const auto again = complete_bare_robot(*bare, model);
  EXPECT_EQ(again->overlaps, completed.overlaps);
}

}  // namespace
}  // namespace retarget
