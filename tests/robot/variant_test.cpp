// Variants: joints held and omitted from the columns.

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <sstream>

#include "retarget/kinematic_tree.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "robot/model/limits.h"
#include "shipped_robots.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kProfile = R"({
  "name": "two_arms",
  "limit_sets": {"narrow": {"ranges": {"right_shoulder": [0.2, 0.4]}}},
  "variants": {"one_arm": {"locked": {"right_slide": 0.05, "right_shoulder": -0.3}}}})";

std::shared_ptr<const Robot> two_arms(const std::string& profile = kProfile) {
  const TemporaryFolder folder;
  return value_of(
      load_robot_files(folder.write("robot.xml", kTwoArms), folder.write("robot.json", profile)));
}

std::vector<std::string> columns_of(const Robot& robot) {
  std::vector<std::string> names;
  for (const int joint : robot.output_joints()) names.push_back(robot.joints()[joint].name);
  return names;
}

TEST(RobotVariantTest, HeldJointsLeaveColumnsAndLimitSets) {
  const auto whole = two_arms();
  const auto variant = value_of(robot_variant(whole, "one_arm"));
  const Robot& robot = *variant;
  EXPECT_EQ(robot.variant().name, "one_arm");
  EXPECT_EQ(robot.name(), "two_arms");
  EXPECT_THAT(columns_of(robot), ElementsAre("left_shoulder", "left_elbow", "left_twist"));
  EXPECT_THAT(robot.zero_configuration(), ElementsAre(0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0.05, -0.3));
  const TemporaryFolder folder;
  const std::string file = folder.write("file.json", R"({"right_slide": [0, 0.1]})");
  for (const std::string& set : {std::string("model"), std::string("narrow"), file}) {
    const auto limits = value_of(load_limits(robot, set));
    EXPECT_EQ(limits.lower[3], 0.05) << set;
    EXPECT_EQ(limits.upper[3], 0.05) << set;
    EXPECT_EQ(limits.lower[4], -0.3) << set;
    EXPECT_EQ(limits.upper[4], -0.3) << set;
    EXPECT_EQ(limits.upper[0], 1.5) << set;
  }
  // The whole robot does not change.
  EXPECT_EQ(whole->output_joints().size(), 5U);
  EXPECT_EQ(whole->model_limits().lower[4], -2.0);
  EXPECT_EQ(whole->zero_configuration()[11], 0.1);
}

TEST(RobotVariantTest, FullJointCountIsTheWholeRobot) {
  const auto whole = two_arms();
  EXPECT_EQ(robot_variant(whole, "5").value(), whole);
}

TEST(RobotVariantTest, UnknownNamesSuggestAndList) {
  const auto variant = robot_variant(two_arms(), "one_arn");
  ASSERT_FALSE(variant);
  EXPECT_EQ(variant.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(variant.error().message,
              AllOf(HasSubstr("two_arms"), HasSubstr("did you mean \"one_arm\"?")));
  EXPECT_THAT(variant.error().hint, HasSubstr("5, one_arm"));
  const auto without = robot_variant(two_arms(R"({"name": "two_arms"})"), "4");
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().hint, HasSubstr("all 5 joints"));
}

TEST(RobotVariantTest, HeldJointsAreNotAtALimit) {
  const auto variant = robot_variant(two_arms(), "one_arm").value();
  RobotClip clip(variant, {30, 1}, 2);
  clip.qpos(1)[8] = 2.4;
  const auto nearest = nearest_limit(clip, variant->model_limits()).value();
  EXPECT_EQ(nearest.joint, "left_elbow");
}

TEST(RobotVariantTest, G1VariantsMatchPublishedOnes) {
  const auto g1 = load_shipped("unitree_g1");
  const auto all = columns_of(*g1);
  const auto without = [&](const std::vector<int>& columns) {
    std::vector<std::string> names;
    for (int c = 0; c < 29; ++c) {
      if (std::ranges::find(columns, c) == columns.end()) names.push_back(all[c]);
    }
    return names;
  };
  // Columns: 13, 14 waist roll and pitch; 19 to 21 and 26 to 28 the wrists.
  const std::map<std::string, std::vector<int>> variants = {{"29", {}},
                                                            {"27", {13, 14}},
                                                            {"23", {13, 14, 20, 21, 27, 28}},
                                                            {"23-pbhc", {19, 20, 21, 26, 27, 28}}};
  for (const auto& [name, held] : variants) {
    const auto variant = value_of(robot_variant(g1, name));
    EXPECT_EQ(columns_of(*variant), without(held)) << name;
    // An own model has no joints to hold.
    EXPECT_EQ(variant->whole() != nullptr, name == "23");
    EXPECT_EQ(variant->joints().size(), name == "23" ? 23U : 29U);
    if (name == "23") continue;
    for (const int joint : held) {
      EXPECT_EQ(variant->model_limits().lower[joint], 0.0);
      EXPECT_EQ(variant->model_limits().upper[joint], 0.0);
    }
  }
  const auto message = robot_variant(g1, "23-pbch").error().message;
  EXPECT_THAT(message, HasSubstr("\"23-pbhc\"?"));
}

// The two-armed robot without the right arm.
constexpr const char* kOneArm = R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="base" pos="0 0 1">
      <freejoint/>
      <geom size="0.1" mass="1"/>
      <body name="left_upper" pos="0 0.25 0.1">
        <joint name="left_elbow" axis="1 0 1" range="0 2"/>
        <joint name="left_shoulder" axis="0 1 0" range="-1 1.5"/>
        <geom size="0.05" mass="1"/>
        <body name="left_lower" pos="0 0.3 0">
          <joint name="left_twist" axis="0 1 0"/>
          <geom size="0.05" mass="1"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

constexpr const char* kProfileWithModel = R"({
  "name": "two_arms",
  "joint_order": ["right_slide", "left_twist", "right_shoulder", "left_elbow", "left_shoulder"],
  "limit_sets": {"narrow": {"source": "s", "ranges": {"left_elbow": [0.2, 0.4],
                                                      "right_shoulder": [0.1, 0.2]}}},
  "speed_limits": {"left_elbow": 3, "right_slide": 1},
  "t_pose": {"left_elbow": 0.5, "right_slide": 0.1},
  "soles": {"left": {"body": "left_lower", "points": [[0, 0, 0]]}},
  "allowed_self_contact": [["left_lower", "base"], ["right_upper", "base"]],
  "variants": {"one_arm": {"model": "one_arm.xml",
                           "locked": {"right_slide": 0.05, "right_shoulder": -0.3}}}})";

Result<std::shared_ptr<const Robot>> one_arm(const std::string& model,
                                             const std::string& profile = kProfileWithModel) {
  const TemporaryFolder folder;
  folder.write("one_arm.xml", model);
  const auto robot = value_of(
      load_robot_files(folder.write("robot.xml", kTwoArms), folder.write("robot.json", profile)));
  return robot_variant(robot, "one_arm");
}

TEST(RobotVariantTest, OwnModelsUseTheProfileByNames) {
  const auto variant = value_of(one_arm(kOneArm));
  const Robot& robot = *variant;
  ASSERT_NE(robot.whole(), nullptr);
  EXPECT_EQ(robot.whole()->joints().size(), 5U);
  EXPECT_EQ(robot.name(), "two_arms");
  EXPECT_EQ(robot.variant().name, "one_arm");
  EXPECT_EQ(robot.configuration_size(), 10);
  EXPECT_THAT(columns_of(robot), ElementsAre("left_twist", "left_elbow", "left_shoulder"));
  const auto limits = value_of(load_limits(robot, "narrow"));
  EXPECT_EQ(limits.source, "s");
  EXPECT_THAT(limits.upper, ElementsAre(0.4, 1.5, testing::Gt(1e9)));
  EXPECT_EQ(robot.model_limits().upper[0], 2.0);
  EXPECT_EQ(robot.speed_limit(0), 3.0);
  EXPECT_EQ(robot.profile().t_pose.size(), 1U);
  EXPECT_EQ(robot.bodies()[robot.profile().soles.at(0).body].name, "left_lower");
  ASSERT_EQ(robot.profile().allowed_self_contact.size(), 1U);
  EXPECT_EQ(robot.bodies()[robot.profile().allowed_self_contact[0].first].name, "left_lower");
  // A limits file may be for the whole robot.
  const TemporaryFolder folder;
  const auto file = folder.write("l.json", R"({"right_slide": [0, 0.1], "left_elbow": [0, 1]})");
  ASSERT_TRUE(load_limits(robot, file)) << describe(load_limits(robot, file).error());
  EXPECT_EQ(load_limits(robot, file)->upper[0], 1.0);
  // Converts between the variant's motions and the whole robot's: joints by name, missing ones at
  // their held position.
  RobotClip clip(variant, {30, 1}, 1);
  for (int i = 0; i < 3; ++i) clip.qpos(0)[7 + i] = 0.1 * (i + 1);
  const RobotClip all = with_robot(clip, robot.whole());
  EXPECT_THAT(std::vector(all.qpos(0).begin() + 7, all.qpos(0).end()),
              ElementsAre(0.2, 0.1, 0.1 * 3, 0, 0.1));
  const RobotClip again = with_robot(all, variant);
  EXPECT_THAT(std::vector(again.qpos(0).begin() + 7, again.qpos(0).end()),
              ElementsAre(0.1, 0.2, 0.1 * 3));
}

TEST(RobotVariantTest, RejectsModelsOfOtherRobots) {
  const auto text_of = [](std::string model, const std::string& from, const std::string& to) {
    const std::size_t at = model.find(from);
    EXPECT_NE(at, std::string::npos);
    const auto variant = one_arm(model.replace(at, from.size(), to));
    EXPECT_FALSE(variant);
    if (variant) return std::string();
    EXPECT_EQ(variant.error().kind, ErrorKind::kConfig);
    return describe(variant.error());
  };
  const std::string model = kOneArm;
  EXPECT_THAT(text_of(model, "left_twist", "left_twits"),
              AllOf(HasSubstr("\"left_twits\", which the robot does not have"),
                    HasSubstr("did you mean \"left_twist\"?"),
                    HasSubstr("lacks the joint \"left_twist\"")));
  EXPECT_THAT(text_of(model, "left_twist", "right_slide"), HasSubstr("which the variant locks"));
  EXPECT_THAT(text_of(model, "\"base\"", "\"root\""), HasSubstr("free joint on \"base\""));
  EXPECT_THAT(text_of(model, "\"left_lower\"", "\"lower\""),
              HasSubstr("lacks the body \"left_lower\" of a sole"));
  EXPECT_THAT(text_of(model, "<freejoint/>", ""), HasSubstr("free joint"));
  EXPECT_THAT(text_of(model, "</mujoco>", ""), HasSubstr("one_arm.xml"));
  const auto missing = one_arm(model, [] {
    std::string profile = kProfileWithModel;
    return profile.replace(profile.find("one_arm.xml"), 11, "no_such.xml");
  }());
  ASSERT_FALSE(missing);
  EXPECT_THAT(describe(missing.error()), HasSubstr("no_such.xml"));
}

TEST(RobotVariantTest, AnchorsMoveAlongTheJointsAxes) {
  const auto anchored = [](const std::string& anchors) {
    std::string profile = kProfileWithModel;
    const std::string before = "\"locked\": {\"right_slide\"";
    return one_arm(kOneArm,
                   profile.replace(profile.find(before), 0, "\"anchors\": {" + anchors + "}, "));
  };
  const auto plain = one_arm(kOneArm).value();
  const int elbow = plain->find_joint("left_elbow").value();
  const RobotJoint& joint = plain->joints()[elbow];
  const Eigen::Vector3d point = joint.anchor + 0.25 * joint.axis;
  std::ostringstream list;
  list.precision(17);
  list << "\"left_elbow\": [" << point.x() << ", " << point.y() << ", " << point.z() << "]";
  const auto moved = value_of(anchored(list.str()));
  EXPECT_LT((moved->joints()[elbow].anchor - point).norm(), 1e-15);
  std::vector<double> qpos = plain->zero_configuration();
  for (std::size_t i = 7; i < qpos.size(); ++i) qpos[i] += 0.3;
  std::vector<Pose> expected(plain->bodies().size()), found(plain->bodies().size());
  forward_kinematics(*plain, qpos, expected);
  forward_kinematics(*moved, qpos, found);
  for (std::size_t b = 0; b < found.size(); ++b) {
    EXPECT_LT((found[b].translation - expected[b].translation).norm(), 1e-12);
  }
  const auto fault_of = [&](const std::string& anchors) {
    const auto variant = anchored(anchors);
    EXPECT_FALSE(variant) << anchors;
    return variant ? std::string() : describe(variant.error());
  };
  EXPECT_THAT(fault_of("\"left_elbow\": [9, 9, 9]"), HasSubstr("does not lie on the joint's axis"));
  EXPECT_THAT(fault_of("\"right_shoulder\": [0, 0, 0]"), HasSubstr("no such joint"));
}

// tests/io/variant_bodies_test.cpp compares the kinematics with the maker's.
TEST(RobotVariantTest, G1With23JointsMatchesTheFullModelElsewhere) {
  const auto g1 = load_shipped("unitree_g1");
  const auto variant = robot_variant(g1, "23").value();
  for (const RobotJoint& joint : variant->joints()) {
    const int of_whole = g1->find_joint(joint.name).value();
    EXPECT_EQ(joint.axis, g1->joints()[of_whole].axis) << joint.name;
    const int index = variant->find_joint(joint.name).value();
    EXPECT_EQ(variant->model_limits().lower[index], g1->model_limits().lower[of_whole]);
    EXPECT_EQ(variant->model_limits().upper[index], g1->model_limits().upper[of_whole]);
    EXPECT_EQ(variant->speed_limit(index), g1->speed_limit(of_whole)) << joint.name;
    const auto body = g1->find_body(variant->bodies()[joint.body].name);
    if (!body) continue;  // the hand on the wrist's roll joint
    EXPECT_EQ(variant->model()->body_mass[joint.body], g1->model()->body_mass[*body]) << joint.name;
  }
  // Pelvis, legs, torso with its head, arms.
  constexpr double kMass = 3.813 + 2 * (1.35 + 1.52 + 1.702 + 1.932 + 0.074 + 0.608) + 7.818 +
                           2 * (0.718 + 0.643 + 0.734 + 0.6 + 0.356929);
  // Frame bodies have a milligram each.
  EXPECT_NEAR(variant->model()->body_subtreemass[0], kMass, 1e-4);
  // Equal number of shapes, at equal positions in the zero configuration.
  EXPECT_EQ(variant->collision_shapes().size(), g1->collision_shapes().size());
  std::vector<Pose> whole_poses(g1->bodies().size()), poses(variant->bodies().size());
  forward_kinematics(*g1, g1->zero_configuration(), whole_poses);
  forward_kinematics(*variant, variant->zero_configuration(), poses);
  for (std::size_t b = 1; b < poses.size(); ++b) {
    const auto body = g1->find_body(variant->bodies()[b].name);
    if (!body) continue;
    EXPECT_LT((poses[b].translation - whole_poses[*body].translation).norm(), 1e-9)
        << variant->bodies()[b].name;
  }
  // Forearms have equal lengths: one wrist axis instead of three.
  const TreeState whole(g1->tree(), g1->zero_configuration());
  const TreeState own(variant->tree(), variant->zero_configuration());
  for (const std::string side : {"left", "right"}) {
    std::vector<int> wrist;
    for (const char* axis : {"_wrist_roll_joint", "_wrist_pitch_joint", "_wrist_yaw_joint"}) {
      wrist.push_back(g1->find_joint(side + axis).value());
    }
    const std::vector<int> roll = {variant->find_joint(side + "_wrist_roll_joint").value()};
    EXPECT_LT((common_point(whole, wrist) - common_point(own, roll)).norm(), 1e-3) << side;
  }
}

TEST(RobotVariantTest, CanOmitHands) {
  const auto variant = value_of(robot_variant(load_shipped("unitree_g1_with_hands"), "29"));
  EXPECT_EQ(columns_of(*variant), columns_of(*load_shipped("unitree_g1")));
}

}  // namespace
}  // namespace retarget
