// Hands of robots are found from their trees: fingers of branches, palm axes, finger ends and
// coupled joints.

#include "robot/anatomy/robot_hands.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "robot/shipped_robots.h"
#include "support/hand_robots.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

std::vector<Finger> fingers_of(const RobotHand& hand) {
  std::vector<Finger> fingers;
  for (const RobotFinger& finger : hand.fingers) fingers.push_back(finger.finger);
  return fingers;
}

void expect_near(const Eigen::Vector3d& found, const Eigen::Vector3d& expected) {
  EXPECT_LT((found - expected).norm(), 1e-9) << found.transpose();
}

TEST(RobotHandsTest, FindsTheThreeFingersOfTheG1) {
  const auto robot = load_shipped("unitree_g1_with_hands");
  const RobotHands hands = find_hands(*robot);
  for (std::size_t side = 0; side < 2; ++side) {
    ASSERT_TRUE(hands[side]);
    const RobotHand& hand = *hands[side];
    const double s = side == 0 ? 1.0 : -1.0;
    EXPECT_EQ(hand.side, kSides[side]);
    EXPECT_EQ(robot->bodies()[hand.palm_body].name,
              side == 0 ? "left_wrist_yaw_link" : "right_wrist_yaw_link");
    EXPECT_EQ(fingers_of(hand), (std::vector{Finger::kThumb, Finger::kIndex, Finger::kMiddle}));
    EXPECT_FALSE(hand.is_gripper);
    EXPECT_EQ(hand.variables.size(), 7U);
    // Fingers point along x of the palm link, the thumb across the palm; the index finger is above.
    expect_near(hand.palm_axes.col(0), {1, 0, 0});
    expect_near(hand.palm_axes.col(1), {0, 0, 1});
    expect_near(hand.palm_axes.col(2), {0, -s, 0});
    EXPECT_EQ(hand.fingers[0].corners.size(), 3U);
    EXPECT_EQ(hand.fingers[1].corners.size(), 2U);
    EXPECT_NEAR(hand.fingers[1].length, 0.0458 + 0.038, 1e-9);
    expect_near(hand.fingers[1].tip, {0.038, 0, 0});
    EXPECT_EQ(hand.fingers[1].tip_radius, 0.01);
  }
}

TEST(RobotHandsTest, OuterJointsFollowInnerOnes) {
  const auto robot = robot_from_text(six_motor_hands());
  const RobotHands hands = find_hands(*robot);
  for (std::size_t side = 0; side < 2; ++side) {
    ASSERT_TRUE(hands[side]);
    const RobotHand& hand = *hands[side];
    EXPECT_EQ(fingers_of(hand), std::vector(kFingers.begin(), kFingers.end()));
    EXPECT_EQ(hand.joints.size(), 12U);
    EXPECT_EQ(hand.variables.size(), 6U);
    // In the world of the zero configuration, in which no body is rotated.
    const Eigen::Matrix3d axes =
        robot->tree().attachment(hand.palm_body).link_from_body.rotation.conjugate() *
        hand.palm_axes;
    expect_near(axes.col(0), {0, side == 0 ? 1.0 : -1.0, 0});
    EXPECT_GT(axes(0, 1), 0.99) << "thumbs are ahead";
    EXPECT_LT(axes(2, 2), -0.99) << "palms are down";
    for (const HandJoint& joint : hand.joints) {
      const std::string& name = robot->joints()[joint.joint].name;
      const std::string& leader = robot->joints()[hand.variables[joint.variable]].name;
      const bool is_thumb = name.find("thumb") != std::string::npos;
      if (name.ends_with("_intermediate")) {
        EXPECT_TRUE(leader.ends_with(is_thumb ? "_pitch" : "_proximal"));
        EXPECT_EQ(joint.ratio, is_thumb ? 1.3 : 1.1);
        EXPECT_EQ(joint.offset, is_thumb ? 0.0 : -0.04);
      } else if (!name.ends_with("_distal")) {
        EXPECT_EQ(leader, name);
      }
    }
  }
}

TEST(RobotHandsTest, NamesAreNotNeeded) {
  const auto robot = robot_from_text(
      scramble_names(humanoid_with_hands([](const std::string& side, const std::string& s) {
        std::string text;
        const auto finger = [&](const std::string& name, const std::string& at,
                                const std::string& way, const std::string& axis) {
          text += "<body name=\"" + side + name + "\" pos=\"" + at +
                  "\"><inertial pos=\"0 0 0\" mass=\"0.01\" diaginertia=\"1 1 1\"/><joint name=\"" +
                  side + name + "j\" axis=\"" + axis +
                  "\" range=\"0 1.5\"/><geom type=\"capsule\" "
                  "size=\"0.008\" fromto=\"0 0 0 " +
                  way + "\"/></body>";
        };
        const std::string bend = s.empty() ? "-1 0 0" : "1 0 0";
        finger("a", "-0.02 " + s + "0.09 0", "0 " + s + "0.08 0", bend);
        finger("b", "0.0 " + s + "0.09 0", "0 " + s + "0.08 0", bend);
        finger("c", "0.02 " + s + "0.09 0", "0 " + s + "0.08 0", bend);
        finger("d", "0.03 " + s + "0.03 0", "0.06 " + s + "0.03 0", "0 1 0");
        return text;
      })));
  const RobotHands hands = find_hands(*robot);
  for (std::size_t side = 0; side < 2; ++side) {
    ASSERT_TRUE(hands[side]);
    const RobotHand& hand = *hands[side];
    EXPECT_EQ(fingers_of(hand),
              (std::vector{Finger::kThumb, Finger::kIndex, Finger::kMiddle, Finger::kRing}));
    EXPECT_EQ(hand.fingers[0].joints, (std::vector{3}));
    EXPECT_EQ(hand.fingers[1].joints, (std::vector{2})) << "the index finger is next to the thumb";
    EXPECT_EQ(hand.fingers[3].joints, (std::vector{0}));
    EXPECT_GT(hand.palm_axes(0, 1), 0.99);
  }
}

// Bodies of the fingers' first joints, thumb first.
std::vector<std::string> first_bodies(const Robot& robot) {
  std::vector<std::string> names;
  const RobotHands hands = find_hands(robot);
  EXPECT_TRUE(hands[0]);
  if (!hands[0]) return names;
  for (const RobotFinger& finger : hands[0]->fingers) {
    const int joint = hands[0]->joints[static_cast<std::size_t>(finger.joints.front())].joint;
    names.push_back(robot.bodies()[static_cast<std::size_t>(robot.joints()[joint].body)].name);
  }
  return names;
}

std::string renamed(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
    text.replace(at, from.size(), to);
    at += to.size();
  }
  return text;
}

TEST(RobotHandsTest, ANamedThumbIsTheThumb) {
  const std::vector<std::string> by_shape = {"left_branch_base", "left_mcp_1", "left_mcp_2",
                                             "left_mcp_3"};
  const std::string unnamed = leap_like_hands(false);
  EXPECT_EQ(first_bodies(*robot_from_text(unnamed)), by_shape);
  EXPECT_EQ(first_bodies(*robot_from_text(leap_like_hands())).front(), "left_thumb_base");
  // The name takes precedence over the shape.
  const auto robot = robot_from_text(renamed(unnamed, "_mcp_1\"", "_mcp_1_thumb\""));
  EXPECT_EQ(first_bodies(*robot).front(), "left_mcp_1_thumb");
  EXPECT_TRUE(find_hands(*robot)[0]->fingers[0].is_named);
  EXPECT_FALSE(find_hands(*robot)[0]->fingers[1].is_named);
}

TEST(RobotHandsTest, LettersNameFingers) {
  std::string text = leap_like_hands(false);
  for (const auto& [from, to] : {std::pair("_mcp_1\"", "_rf_bs\""),
                                 {"_mcp_2\"", "_mf_bs\""},
                                 {"_mcp_3\"", "_if_bs\""},
                                 {"_branch_base\"", "_th_mp\""}}) {
    text = renamed(text, from, to);
  }
  EXPECT_EQ(first_bodies(*robot_from_text(text)),
            (std::vector<std::string>{"left_th_mp", "left_if_bs", "left_mf_bs", "left_rf_bs"}));
}

TEST(RobotHandsTest, TwoJawsAreAGripper) {
  const auto robot = robot_from_text(grippers());
  const RobotHands hands = find_hands(*robot);
  for (const auto& hand : hands) {
    ASSERT_TRUE(hand);
    EXPECT_TRUE(hand->is_gripper);
    EXPECT_EQ(hand->variables.size(), 1U) << "one jaw follows the other";
    EXPECT_NEAR(hand->opening, 0.09, 1e-9);
    EXPECT_EQ(fingers_of(*hand), (std::vector{Finger::kThumb, Finger::kIndex}));
  }
}

TEST(RobotHandsTest, FindsThoseOfOtherShippedRobots) {
  const std::map<std::string, std::size_t> fingers = {{"engineai_t800", 3}, {"unitree_h2_plus", 5}};
  for (const auto& [name, count] : fingers) {
    const RobotHands hands = find_hands(*load_shipped(name));
    for (const auto& hand : hands) {
      ASSERT_TRUE(hand) << name;
      ASSERT_EQ(hand->fingers.size(), count) << name;
      for (const RobotFinger& finger : hand->fingers) EXPECT_TRUE(finger.is_named) << name;
    }
  }
}

TEST(RobotHandsTest, FindsNoneOnRobotsWithoutThem) {
  const std::set<std::string> with_hands = {"engineai_t800", "unitree_g1_with_hands",
                                            "unitree_h2_plus"};
  int looked_at = 0;
  for (const char* const folder : {"robots", "robots/unverified"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(RETARGET_SOURCE_DIR) / folder)) {
      const std::string name = entry.path().filename().string();
      if (!entry.is_directory() || name == "unverified" || with_hands.contains(name)) continue;
      const RobotHands hands = find_hands(*load_robot_in(entry.path()));
      EXPECT_FALSE(hands[0] || hands[1]) << name;
      ++looked_at;
    }
  }
  EXPECT_GE(looked_at, 15);
}

TEST(RobotHandsTest, IgnoresHeldFingers) {
  const auto robot = value_of(robot_variant(load_shipped("unitree_g1_with_hands"), "29"));
  const RobotHands hands = find_hands(*robot);
  EXPECT_FALSE(hands[0] || hands[1]);
}

TEST(RobotHandsTest, FreesCyclicallyCoupledJoints) {
  const auto loaded = std::const_pointer_cast<Robot>(robot_from_text(six_motor_hands()));
  RobotProfile profile = loaded->profile();
  profile.coupled_joints = {{"left_index_proximal", {"left_index_intermediate", 1.0, 0.0}},
                            {"left_index_intermediate", {"left_index_proximal", 1.0, 0.0}},
                            {"left_ring_proximal", {"left_elbow", 1.0, 0.0}}};
  loaded->set_profile(profile);
  const RobotHands hands = find_hands(*loaded);
  ASSERT_TRUE(hands[0]);
  // A cycle has one driving joint; a joint of the arm drives no joint of the hand.
  EXPECT_EQ(hands[0]->variables.size(), 11U);
}

}  // namespace
}  // namespace retarget
