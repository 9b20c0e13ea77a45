// Robots with the joint layouts of public ones that the analysis once misread: each is accepted
// with limbs that follow the human, or rejected with the reason.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "human/skeleton/calibrate.h"
#include "human/skeleton/recognise.h"
#include "retarget/kinematic_tree.h"
#include "retarget/load_robot.h"
#include "retarget/resample.h"
#include "retarget/rig.h"
#include "retarget/so3.h"
#include "robot/anatomy/limbs.h"
#include "solve/targets/solve_frames.h"
#include "support/angles.h"
#include "support/layout_humanoids.h"
#include "support/temporary_folder.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::Contains;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

HumanClip sample(const std::string& name) {
  const fs::path source(RETARGET_SOURCE_DIR);
  const auto profiles = load_skeleton_profiles(source / "configs" / "skeletons").value();
  const auto bvh = load_bvh((source / "data" / (name + ".bvh")).string()).value();
  const auto map = recognise_skeleton(bvh.clip, profiles).value();
  return to_human(resample(bvh.clip, FrameRate{10, 1}).value(),
                  calibrate(bvh.clip, map, {}).value());
}

// Angles of thighs, shins, upper arms and forearms between robot and human, degrees.
struct LimbAngles {
  double mean = 0.0, worst = 0.0;  // over the limbs' means
};

LimbAngles limb_angles(const Robot& robot, const RobotClip& clip, const HumanClip& human,
                       const LayoutHumanoid& layout) {
  using enum LimbBone;
  struct Segment {
    int body;
    Vector3d way;  // in the body
    Bone from, to;
    double mean = 0.0;
  };
  const TreeState zero(robot.tree(), robot.zero_configuration());
  std::vector<Segment> segments;
  for (const Side side : kSides) {
    const bool is_left = side == Side::kLeft;
    const auto add = [&](const std::string& joint, Vector3d way, LimbBone from, LimbBone to) {
      if (!is_left) way.y() = -way.y();
      const int body = robot.find_body((is_left ? "left_" : "right_") + joint).value();
      segments.push_back({body, zero.world_from_body(body).rotation.conjugate() * way,
                          side_bone(side, from), side_bone(side, to)});
    };
    add(layout.leg.upper, layout.leg.upper_way, kUpLeg, kLeg);
    add(layout.leg.lower, layout.leg.lower_way, kLeg, kFoot);
    add(layout.arm.upper, layout.arm.upper_way, kArm, kForeArm);
    add(layout.arm.lower, layout.arm.lower_way, kForeArm, kHand);
  }
  std::vector<Pose> world_from_body(robot.bodies().size());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(robot, clip.qpos(frame), world_from_body);
    const HumanPose& bones = human.frame(frame);
    for (Segment& segment : segments) {
      segment.mean +=
          kDegrees *
          angle_between(world_from_body[segment.body].rotation * segment.way,
                        bones[segment.to].translation - bones[segment.from].translation) /
          clip.frame_count();
    }
  }
  LimbAngles angles;
  for (const Segment& segment : segments) {
    angles.mean += segment.mean / static_cast<double>(segments.size());
    angles.worst = std::max(angles.worst, segment.mean);
  }
  return angles;
}

// The maximum over the samples, for a robot made as by `robots add`.
LimbAngles angles_of(const LayoutHumanoid& layout) {
  const TemporaryFolder folder;
  const auto made = value_of(make_robot(folder.write("any.xml", layout.built.mjcf()), layout.name));
  const auto written = save_robot(made, folder.path(), false).value();
  const auto robot = load_robot_in(written);
  const auto config = load_retargeting_config((written / "ik.json").string()).value();
  LimbAngles angles;
  for (const std::string name : {"walk", "wave", "squat", "turn_in_place", "get_up"}) {
    const HumanClip human = sample(name);
    const auto solved = value_of(
        solve_frames(human, robot, resolve_config(config, *robot).value(), robot->model_limits()));
    const LimbAngles found = limb_angles(*robot, solved.clip, human, layout);
    std::cout << layout.name << ", " << name << ": limbs " << found.mean << " degrees off, worst "
              << found.worst << "\n";
    angles.mean = std::max(angles.mean, found.mean);
    angles.worst = std::max(angles.worst, found.worst);
  }
  return angles;
}

TEST(RobotLayouts, ForearmRollJointIsNotTheElbow) {
  for (const LayoutHumanoid& layout : {pi_plus_layout(), atom01_layout()}) {
    EXPECT_LT(angles_of(layout).mean, 10.0) << layout.name;
  }
}

TEST(RobotLayouts, RejectsArmsThatCannotFollow) {
  const TemporaryFolder folder;
  const std::string model = folder.write("any.xml", z_bot_layout().built.mjcf());
  const auto made = make_robot(model, "z_bot");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(made.error().message, HasSubstr("degrees off on average"));
  EXPECT_THAT(made.error().message, HasSubstr("its shoulders have 2 joints"));
  RobotSources sources;
  sources.model = model;
  const auto findings = check_robot(sources).value();
  EXPECT_THAT(findings, Contains(::testing::Field(&RobotFinding::text, made.error().message)));
  EXPECT_TRUE(findings.front().fault);
}

TEST(RobotLayouts, ChestMayBeTheRoot) {
  EXPECT_LT(angles_of(qing_long_layout()).mean, 10.0);
}

// The axis of one knee is reversed, but its range is not.
TEST(RobotLayouts, RejectsKneesThatBendToOppositeSides) {
  LayoutHumanoid layout = qing_long_layout();
  for (BuiltJoint& joint : layout.built.leg.joints) {
    if (joint.name != "knee") continue;
    joint.lower = -0.09;
    joint.upper = 2.36;
  }
  std::string text = layout.built.mjcf();
  const std::string range = "range=\"-0.09 2.36\"";
  const std::size_t at = text.find(range, text.find("<joint name=\"right_knee\""));
  ASSERT_NE(at, std::string::npos);
  text.replace(at, range.size(), "range=\"-2.36 0.09\"");
  const TemporaryFolder folder;
  const std::string model = folder.write("any.xml", text);
  const auto made = make_robot(model, "qing_long");
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message,
              HasSubstr("the knees bend in opposite directions: the ranges of "
                        "\"left_knee\" and \"right_knee\""));
  RobotSources sources;
  sources.model = model;
  EXPECT_TRUE(check_robot(sources).value().front().fault);
}

TEST(RobotLayouts, DoesNotMistakeToesOfThreeJointsForFeet) {
  EXPECT_LT(angles_of(smpl_layout()).mean, 10.0);
}

// The toes follow no bone, and both sides are alike, in any order of the hinges.
TEST(RobotLayouts, DoesNotMistakeToesWithAnyHingeOrderForFeet) {
  for (const std::string order : {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}) {
    for (const bool toe_ends : {false, true}) {
      SCOPED_TRACE(order + (toe_ends ? ", with ends" : ""));
      const auto robot = robot_from_text(smpl_layout(order, toe_ends).built.mjcf());
      const auto limbs = value_of(find_limbs(*robot, "any.xml"));
      EXPECT_THAT(limbs.notes, Contains(HasSubstr("\"left_toe_" + order.substr(0, 1) +
                                                  "\" is assumed to be a toe")));
      for (const std::size_t side : {0U, 1U}) {
        const std::string ankle = std::string(side == 0 ? "left" : "right") + "_ankle_" + order[2];
        EXPECT_EQ(robot->bodies()[limbs.legs[side].end->body].name, ankle);
        EXPECT_NEAR(limbs.legs[side].lower_length, 0.402, 0.01);
      }
      for (const auto* pair : {&limbs.legs, &limbs.arms}) {
        EXPECT_EQ((*pair)[0].middle, (*pair)[1].middle);
        EXPECT_EQ((*pair)[0].joints.size(), (*pair)[1].joints.size());
      }
    }
  }
}

TEST(RobotLayouts, DoesNotMistakeUpperArmRollForAnElbow) {
  EXPECT_LT(angles_of(offset_shoulder_layout()).mean, 10.0);
}

TEST(RobotLayouts, HandWithItsOwnWristKeepsTheElbow) {
  EXPECT_LT(angles_of(wristed_hand_layout()).mean, 10.0);
}

}  // namespace
}  // namespace retarget
