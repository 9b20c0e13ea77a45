// Coupled joints of models: equalities of MJCF and mimic of URDF, including their reference
// positions.

#include <gtest/gtest.h>

#include <string>

#include "robot/model/urdf_extras.h"
#include "support/temporary_folder.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

TEST(CouplingsTest, ReadsJointEqualities) {
  const auto robot = robot_from_text(R"(
<mujoco>
  <compiler angle="radian"/>
  <worldbody><body name="base"><freejoint/><geom size="0.1"/>
    <body><joint name="a" axis="0 1 0" ref="0.3"/><geom size="0.1"/>
      <body><joint name="b" axis="0 1 0" ref="0.2"/><geom size="0.1"/></body></body>
  </body></worldbody>
  <equality><joint joint1="b" joint2="a" polycoef="0.1 2 0.5 0 0"/><joint joint1="a"/></equality>
</mujoco>)");
  const auto& couplings = robot->profile().coupled_joints;
  ASSERT_EQ(couplings.size(), 1U) << "a joint that is held at its place follows none";
  const JointCoupling& b = couplings.at("b");
  EXPECT_EQ(b.leader, "a");
  EXPECT_EQ(b.ratio, 2.0);
  // b - 0.2 = 0.1 + 2 (a - 0.3)
  EXPECT_NEAR(b.offset, 0.2 + 0.1 - 2.0 * 0.3, 1e-12);
}

TEST(CouplingsTest, ReadsMimic) {
  const TemporaryFolder folder;
  const std::string path = folder.write("hand.urdf", R"(<robot name="r">
    <joint name="a" type="revolute"/>
    <joint name="b" type="revolute"><mimic joint="a" multiplier="1.5" offset="-0.1"/></joint>
    <joint name="c" type="revolute"><mimic joint="a"/></joint>
    <joint name="d" type="revolute"><mimic joint="a" multiplier="nan"/></joint>
    <joint name="e" type="revolute"><mimic multiplier="2"/></joint></robot>)");
  const auto couplings = urdf_facts(path).couplings;
  ASSERT_EQ(couplings.size(), 2U);
  EXPECT_EQ(couplings.at("b").leader, "a");
  EXPECT_EQ(couplings.at("b").ratio, 1.5);
  EXPECT_EQ(couplings.at("b").offset, -0.1);
  EXPECT_EQ(couplings.at("c").ratio, 1.0);
  EXPECT_EQ(couplings.at("c").offset, 0.0);
  EXPECT_TRUE(urdf_facts(folder.write("model.xml", "<mujoco/>")).couplings.empty());
  EXPECT_TRUE(urdf_facts("/nowhere.urdf").couplings.empty());
}

}  // namespace
}  // namespace retarget
