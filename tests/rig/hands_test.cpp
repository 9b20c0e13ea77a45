// Robots made from models with hands keep the joint couplings of the hands; other couplings are
// dropped with a note.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "retarget/rig.h"
#include "robot/anatomy/robot_hands.h"
#include "support/hand_robots.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

TEST(RigHandsTest, CouplingsOfHandsAreKept) {
  std::string text = six_motor_hands();
  text.insert(text.find("</equality>"),
              "<joint joint1=\"left_elbow\" joint2=\"waist\" polycoef=\"0 1 0 0 0\"/>");
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("made.xml", text), "made"));
  EXPECT_THAT(made.notes,
              Contains(HasSubstr("both joints move freely: \"left_elbow\" to \"waist\"")));
  const auto profile = nlohmann::json::parse(made.profile);
  const auto& couplings = profile.at("coupled_joints");
  EXPECT_EQ(couplings.size(), 12U) << "six a hand";
  EXPECT_EQ(couplings.at("left_thumb_distal").at("joint"), "left_thumb_pitch");
  EXPECT_EQ(couplings.at("right_ring_intermediate").at("ratio"), 1.1);
  EXPECT_EQ(couplings.at("right_ring_intermediate").at("offset"), -0.04);

  // The analysis finds the hand that the generator made.
  const auto robot = value_of(load_robot_files(folder.write("model.xml", made.model),
                                               folder.write("robot.json", made.profile)));
  const RobotHands hands = find_hands(*robot);
  ASSERT_TRUE(hands[0] && hands[1]);
  EXPECT_EQ(hands[0]->variables.size(), 6U);
}

TEST(RigHandsTest, DecisionsNameTheBranchOfEveryFinger) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("made.xml", leap_like_hands()), "made"));
  EXPECT_THAT(made.decisions,
              HasSubstr("| left thumb | left_thumb_base - left_thumb_fingertip | 4 | its name |"));
  EXPECT_THAT(made.decisions, HasSubstr("| right ring | right_mcp_3 - right_fingertip_3 | 4 | "
                                        "its position and direction |"));
  EXPECT_THAT(made.decisions, HasSubstr("rename its first body in model.xml"));
}

}  // namespace
}  // namespace retarget
