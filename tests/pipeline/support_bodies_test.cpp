// Bodies of the included robots that rest on the floor when their humans kneel, lean, sit and lie.

#include "solve/targets/support_bodies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "retarget/kinematic_tree.h"
#include "support/test_robots.h"

namespace retarget {
namespace {

const SupportBody* find(const std::vector<SupportBody>& bodies, Bone bone) {
  const auto found = std::ranges::find_if(
      bodies, [&](const SupportBody& body) { return kSupportBones[body.support] == bone; });
  return found == bodies.end() ? nullptr : &*found;
}

std::string link_name(const Robot& robot, int link) {
  return robot
      .bodies()[static_cast<std::size_t>(robot.tree().links()[static_cast<std::size_t>(link)].body)]
      .name;
}

TEST(SupportBodies, HaveTheExpectedLocationsOnTheG1) {
  const auto robot = load_g1();
  const auto bodies = support_bodies(*robot, published_config(*robot));
  ASSERT_EQ(bodies.size(), kSupportBones.size());
  EXPECT_EQ(link_name(*robot, find(bodies, Bone::kLeftLeg)->link), "left_knee_link");
  EXPECT_EQ(link_name(*robot, find(bodies, Bone::kRightForeArm)->link), "right_elbow_link");
  EXPECT_EQ(link_name(*robot, find(bodies, Bone::kRightHand)->link), "right_wrist_yaw_link");
  EXPECT_EQ(link_name(*robot, find(bodies, Bone::kHips)->link), "pelvis");
  TreeState state(robot->tree());
  state.update(robot->zero_configuration());
  const auto place = [&](const SupportBody::Point& point) -> Eigen::Vector3d {
    return state.world_from_link[static_cast<std::size_t>(point.link)] * point.in_link;
  };
  const auto ankle = [&] {
    for (const Sole& sole : robot->profile().soles) {
      if (sole.side == "left") return robot->tree().attachment(sole.body).link;
    }
    return 0;
  }();
  const double foot = state.world_from_link[static_cast<std::size_t>(ankle)].translation.z();
  for (const SupportBody& body : bodies) {
    ASSERT_FALSE(body.points.empty());
    for (const SupportBody::Point& point : body.points) {
      // The support of a shank is its knee, not its ankle.
      if (kSupportBones[body.support] == Bone::kLeftLeg) EXPECT_GT(place(point).z(), foot + 0.1);
      EXPECT_GE(point.radius, 0.0);
    }
  }
  // Left and right are mirror images.
  for (const auto [left, right] : {std::pair(Bone::kLeftLeg, Bone::kRightLeg),
                                   std::pair(Bone::kLeftForeArm, Bone::kRightForeArm),
                                   std::pair(Bone::kLeftHand, Bone::kRightHand)}) {
    const SupportBody &a = *find(bodies, left), &b = *find(bodies, right);
    ASSERT_EQ(a.points.size(), b.points.size());
    const Eigen::Vector3d at_a = state.world_from_link[static_cast<std::size_t>(a.link)] * a.middle;
    const Eigen::Vector3d at_b = state.world_from_link[static_cast<std::size_t>(b.link)] * b.middle;
    EXPECT_NEAR((at_a - Eigen::Vector3d(at_b.x(), -at_b.y(), at_b.z())).norm(), 0.0, 2e-3);
  }
}

TEST(SupportBodies, ExcludeFeet) {
  const auto robot = load_g1();
  for (const SupportBody& body : support_bodies(*robot, published_config(*robot))) {
    for (const SupportBody::Point& point : body.points) {
      for (const Sole& sole : robot->profile().soles) {
        EXPECT_NE(point.link, robot->tree().attachment(sole.body).link);
      }
    }
  }
}

TEST(SupportBodies, UnmappedBonesHaveNone) {
  const auto robot = load_g1();
  ResolvedConfig config = published_config(*robot);
  const std::array bones = {Bone::kLeftForeArm, Bone::kLeftHand};
  ASSERT_TRUE(leave_out_bones(config, bones));
  const auto bodies = support_bodies(*robot, config);
  EXPECT_EQ(find(bodies, Bone::kLeftForeArm), nullptr);
  EXPECT_EQ(find(bodies, Bone::kLeftHand), nullptr);
  EXPECT_NE(find(bodies, Bone::kRightHand), nullptr);
}

}  // namespace
}  // namespace retarget
