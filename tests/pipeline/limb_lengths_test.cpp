#include "solve/targets/limb_lengths.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <array>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "solve/targets/targets.h"
#include "support/limbed_config.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

// Hips and shoulders of three hinges whose axes meet away from the body origins, ankles of two.
constexpr const char* kLimbed = R"(
<mujoco>
  <compiler angle="radian" inertiafromgeom="true"/>
  <default><geom size="0.02" mass="1"/></default>
  <worldbody>
    <body name="pelvis" pos="0 0 0.7"><freejoint/><geom/>
      <body name="l_hip1" pos="0 0.05 -0.1"><joint axis="0 1 0" range="-1 1"/><geom/>
        <body name="l_hip2" pos="0 0.05 0"><joint axis="1 0 0" range="-1 1"/><geom/>
          <body name="l_thigh" pos="0 0 -0.12"><joint axis="0 0 1" range="-1 1"/><geom/>
            <body name="l_shin" pos="0 0 -0.18"><joint axis="0 1 0" range="-1 1"/><geom/>
              <body name="l_ankle" pos="0 0 -0.25"><joint axis="0 1 0" range="-1 1"/><geom/>
                <body name="l_foot" pos="0.03 0 0"><joint axis="1 0 0" range="-1 1"/><geom/></body>
      </body></body></body></body></body>
      <body name="r_hip1" pos="0 -0.05 -0.1"><joint axis="0 1 0" range="-1 1"/><geom/>
        <body name="r_hip2" pos="0 -0.05 0"><joint axis="1 0 0" range="-1 1"/><geom/>
          <body name="r_thigh" pos="0 0 -0.12"><joint axis="0 0 1" range="-1 1"/><geom/>
            <body name="r_shin" pos="0 0 -0.18"><joint axis="0 1 0" range="-1 1"/><geom/>
              <body name="r_ankle" pos="0 0 -0.25"><joint axis="0 1 0" range="-1 1"/><geom/>
                <body name="r_foot" pos="0.03 0 0"><joint axis="1 0 0" range="-1 1"/><geom/></body>
      </body></body></body></body></body>
      <body name="torso" pos="0 0 0.1"><joint axis="0 0 1" range="-1 1"/><geom/>
        <body name="l_shoulder" pos="0 0.1 0.2"><joint axis="0 1 0" range="-1 1"/><geom/>
          <body name="l_arm" pos="0 0.05 0"><joint axis="1 0 0" range="-1 1"/><geom/>
            <body name="l_elbow" pos="0 0 -0.2"><joint axis="0 1 0" range="-1 1"/><geom/>
              <body name="l_hand" pos="0 0 -0.15"><geom/></body></body></body></body>
        <body name="r_shoulder" pos="0 -0.1 0.2"><joint axis="0 1 0" range="-1 1"/><geom/>
          <body name="r_arm" pos="0 -0.05 0"><joint axis="1 0 0" range="-1 1"/><geom/>
            <body name="r_elbow" pos="0 0 -0.2"><joint axis="0 1 0" range="-1 1"/><geom/>
              <body name="r_hand" pos="0 0 -0.15"><geom/></body></body></body></body>
      </body>
    </body>
  </worldbody>
</mujoco>)";

// A target read from uninitialised memory would change the bytes between runs.
TEST(RobotLimbs, AreZeroIfNotMeasured) {
  alignas(RobotLimbs) std::array<unsigned char, sizeof(RobotLimbs)> memory;
  memory.fill(0xff);  // All values are NaN as doubles.
  const auto* limbs = new (memory.data()) RobotLimbs;
  for (const Eigen::Vector3d& joint : limbs->body_from_joint) {
    EXPECT_EQ(joint, Eigen::Vector3d::Zero());
  }
}

TEST(RobotLimbs, AreMeasuredBetweenAxisIntersections) {
  const auto robot = robot_from_text(kLimbed);
  const auto limbs = value_of(robot_limbs(*robot, resolved(limbed_config(), *robot)));
  // The hip axes meet at its second body, 12 cm above the thigh's origin; the pull towards the
  // anchors moves the centre by millimetres.
  EXPECT_NEAR(limbs.lengths.leg, 0.30 + 0.25, 2e-3);
  EXPECT_NEAR(limbs.lengths.arm, 0.20 + 0.15, 2e-3);
  EXPECT_NEAR(limbs.lengths.trunk, 0.40, 2e-3);
  const auto centre = [&](const char* bone) {
    return limbs.body_from_joint[bone_from_name(bone).value()];
  };
  EXPECT_LT((centre("LeftUpLeg") - Eigen::Vector3d(0, 0, 0.12)).norm(), 2e-3);
  EXPECT_LT((centre("RightFootMod") - Eigen::Vector3d(-0.03, 0, 0)).norm(), 2e-2);
  EXPECT_LT((centre("Hips") - Eigen::Vector3d(0, 0, -0.1)).norm(), 2e-3);
  EXPECT_EQ(limbs.ankle_height, std::nullopt);
}

void replace_once(std::string& text, const std::string& from, const std::string& to) {
  ASSERT_NE(text.find(from), std::string::npos) << from;
  text.replace(text.find(from), from.size(), to);
}

// The origins of shins and forearms are away from their joints, which are in frames above them, as
// `robots add` writes joints with an offset.
std::string with_joint_frames() {
  const std::string joint = "<joint axis=\"0 1 0\" range=\"-1 1\"/><geom/>";
  std::string text = kLimbed;
  for (const std::string side : {"l_", "r_"}) {
    const auto frame = [&](const std::string& body, const std::string& at) {
      replace_once(text, "<body name=\"" + side + body + "\" pos=\"" + at + "\">" + joint,
                   "<body name=\"" + side + body + "_frame\" pos=\"" + at + "\">" + joint +
                       "<body name=\"" + side + body + "\" pos=\"0 -0.04 0.05\"><geom/>");
    };
    frame("shin", "0 0 -0.18");
    replace_once(text, side + "ankle\" pos=\"0 0 -0.25\"", side + "ankle\" pos=\"0 0.04 -0.3\"");
    const std::string foot = side + "foot\" pos=\"0.03 0 0\"><joint axis=\"1 0 0\"";
    replace_once(text, foot + " range=\"-1 1\"/><geom/></body>",
                 foot + " range=\"-1 1\"/><geom/></body></body>");
    frame("elbow", "0 0 -0.2");
    replace_once(text, side + "hand\" pos=\"0 0 -0.15\"><geom/></body>",
                 side + "hand\" pos=\"0 0.04 -0.2\"><geom/></body></body>");
  }
  return text;
}

TEST(RobotLimbs, JointFramesBelongToTheBodiesBelowThem) {
  const auto plain = robot_from_text(kLimbed);
  const auto expected = robot_limbs(*plain, resolved(limbed_config(), *plain));
  const auto bare = robot_from_text(with_joint_frames());
  RobotProfile profile = bare->profile();
  profile.joint_frames = {"l_shin_frame", "r_shin_frame", "l_elbow_frame", "r_elbow_frame"};
  const Robot robot(ModelPtr(mj_copyModel(nullptr, bare->model())), std::move(profile));
  const auto limbs = value_of(robot_limbs(robot, resolved(limbed_config(), robot)));
  EXPECT_NEAR(limbs.lengths.leg, expected->lengths.leg, 1e-9);
  EXPECT_NEAR(limbs.lengths.arm, expected->lengths.arm, 1e-9);
  EXPECT_NEAR(limbs.lengths.trunk, expected->lengths.trunk, 1e-9);
  for (const char* bone : {"LeftLeg", "RightLeg", "LeftForeArm", "RightForeArm"}) {
    const Eigen::Vector3d& joint = limbs.body_from_joint[bone_from_name(bone).value()];
    EXPECT_LT((joint - Eigen::Vector3d(0, 0.04, -0.05)).norm(), 1e-9) << bone;
  }
}

// The anchor of the joint that twists the forearm is at the elbow, so the origin of its body marks
// the wrist, but only along the forearm.
TEST(RobotLimbs, WristsAreOnTheAxisThatTwistsTheForearm) {
  std::string text = kLimbed;
  for (const std::string side : {"l_", "r_"}) {
    replace_once(text, side + "hand\" pos=\"0 0 -0.15\"><geom/>",
                 side +
                     "hand\" pos=\"0.03 0 -0.15\"><geom/>"
                     "<joint axis=\"0 0 1\" range=\"-1 1\" pos=\"-0.03 0 0.15\"/>");
  }
  const auto robot = robot_from_text(text);
  const auto limbs = value_of(robot_limbs(*robot, resolved(limbed_config(), *robot)));
  const Eigen::Vector3d& wrist = limbs.body_from_joint[bone_from_name("LeftHand").value()];
  EXPECT_LT((wrist - Eigen::Vector3d(-0.03, 0, 0)).norm(), 1e-9);
}

TEST(RobotLegLength, DoesNotNeedArms) {
  const auto robot = robot_from_text(kLimbed);
  RetargetingConfig config = limbed_config();
  EXPECT_EQ(robot_leg_length(*robot, resolved(config, *robot)).value(),
            robot_limbs(*robot, resolved(config, *robot)).value().lengths.leg);
  const auto leave_out = [&](std::string_view ending) {
    std::erase_if(config.match_tables[0].rows,
                  [&](const IkMatch& row) { return row.bone.ends_with(ending); });
  };
  leave_out("Arm");
  EXPECT_FALSE(robot_limbs(*robot, resolved(config, *robot)));
  EXPECT_NEAR(robot_leg_length(*robot, resolved(config, *robot)).value(), 0.30 + 0.25, 2e-3);
  leave_out("FootMod");
  EXPECT_FALSE(robot_leg_length(*robot, resolved(config, *robot)));
}

TEST(RobotLimbs, EndAtTheElbowsWithoutMappedHands) {
  const auto robot = robot_from_text(kLimbed);
  RetargetingConfig config = limbed_config();
  std::erase_if(config.match_tables[0].rows,
                [](const IkMatch& row) { return row.bone.ends_with("Hand"); });
  const auto limbs = value_of(robot_limbs(*robot, resolved(config, *robot)));
  EXPECT_FALSE(limbs.forearms);
  EXPECT_NEAR(limbs.lengths.arm, 0.20, 2e-3);
  EXPECT_NEAR(limbs.lengths.leg, 0.30 + 0.25, 2e-3);
  EXPECT_TRUE(robot_limbs(*robot, resolved(limbed_config(), *robot))->forearms);
  // The human's arms are then measured to the same point.
  HumanPose bones;
  bones[Bone::kLeftForeArm].translation = {0, 0.3, 0};
  bones[Bone::kRightForeArm].translation = {0, -0.3, 0};
  bones[Bone::kLeftHand].translation = {0, 0.5, 0};
  bones[Bone::kRightHand].translation = {0, -0.5, 0};
  EXPECT_NEAR(human_limb_lengths(bones, false).arm, 0.3, 1e-12);
  EXPECT_NEAR(human_limb_lengths(bones).arm, 0.5, 1e-12);
}

TEST(RobotLimbs, MatchTheG1) {
  const auto robot = load_g1();
  const ResolvedConfig config = published_config(*robot);
  const auto limbs = value_of(robot_limbs(*robot, config));
  // From the model: the hips are 3 cm below the pitch axis, the shins are 300 mm long.
  EXPECT_NEAR(limbs.lengths.leg, 0.62, 0.03);
  EXPECT_NEAR(limbs.lengths.arm, 0.37, 0.06);
  ASSERT_TRUE(limbs.ankle_height);
  // The ankle axes are 17.558 mm apart, the lower one is 35.4 mm above the sole.
  EXPECT_GT(*limbs.ankle_height, 0.0354);
  EXPECT_LT(*limbs.ankle_height, 0.0354 + 0.0176);
}

TEST(RobotLimbs, NeedTheMappedBodies) {
  const auto robot = robot_from_text(kLimbed);
  RetargetingConfig config = limbed_config();
  std::erase_if(config.match_tables[0].rows,
                [](const IkMatch& row) { return row.bone == "LeftHand"; });
  const auto missing = robot_limbs(*robot, resolved(config, *robot));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kConfig);
  EXPECT_THAT(missing.error().message, testing::HasSubstr("no body follows LeftHand"));

  config = limbed_config();
  for (IkMatch& row : config.match_tables[0].rows) {
    if (row.bone == "RightLeg") row.body = "l_shin";
  }
  const auto crossed = robot_limbs(*robot, resolved(config, *robot));
  ASSERT_FALSE(crossed);
  EXPECT_THAT(crossed.error().message, testing::HasSubstr("do not form a chain"));
}

// A human with the robot's limbs, each stretched: the targets must be the robot's own bodies for
// any pose of both.
TEST(TargetBuilder, LimbScalingReproducesTheRobotPose) {
  const auto robot = robot_from_text(kLimbed);
  const RetargetingConfig config = limbed_config();
  const auto limbs = robot_limbs(*robot, resolved(config, *robot)).value();
  std::vector<double> qpos = robot->zero_configuration();
  // Knees and elbows bend; the centres of shoulders and hips stay where their axes meet.
  for (const RobotJoint& joint : robot->joints()) {
    const std::string& body = robot->bodies()[joint.body].name;
    if (body.ends_with("shin")) qpos[joint.qpos_address] = 0.7;
    if (body.ends_with("elbow")) qpos[joint.qpos_address] = -0.9;
  }
  std::vector<Pose> world_from_body(robot->bodies().size());
  forward_kinematics(*robot, qpos, world_from_body);

  constexpr double kLeg = 1.4, kTrunk = 1.25, kArm = 1.7;  // the human's over the robot's
  HumanPose bones;
  BoneArray<Eigen::Vector3d> centre;
  for (const IkMatch& row : config.match_tables[0].rows) {
    const Bone bone = bone_from_name(row.bone).value();
    const Pose& body = world_from_body[robot->find_body(row.body).value()];
    bones[bone].rotation = body.rotation;
    centre[bone] = body.translation + body.rotation * limbs.body_from_joint[bone];
  }
  const auto index = [](const std::string& bone) { return bone_from_name(bone).value(); };
  const Eigen::Vector3d hips = centre[index("Hips")];
  const auto place = [&](const std::string& bone, const std::string& from, double stretch) {
    bones[index(bone)].translation =
        bones[index(from)].translation + stretch * (centre[index(bone)] - centre[index(from)]);
  };
  bones[index("Hips")].translation = kLeg * hips;
  place("Spine2", "Hips", kTrunk);
  for (const std::string side : {"Left", "Right"}) {
    place(side + "UpLeg", "Hips", kLeg);
    place(side + "Leg", "Hips", kLeg);
    place(side + "FootMod", "Hips", kLeg);
    place(side + "Arm", "Hips", kTrunk);
    place(side + "ForeArm", side + "Arm", kArm);
    place(side + "Hand", side + "Arm", kArm);
  }
  const LimbLengths human = {kLeg * limbs.lengths.leg, kArm * limbs.lengths.arm,
                             kTrunk * limbs.lengths.trunk};
  const TargetBuilder builder(resolved(config, *robot), limbs, human);
  std::vector<Pose> targets(static_cast<std::size_t>(builder.target_count()));
  builder.build(bones, targets);
  for (const IkMatch& row : config.match_tables[0].rows) {
    const Pose& body = world_from_body[robot->find_body(row.body).value()];
    const Pose& target = targets[builder.target_of(index(row.bone))];
    EXPECT_LT((target.translation - body.translation).norm(), 1e-12) << row.bone;
    EXPECT_LT(target.rotation.angularDistance(body.rotation), 1e-7) << row.bone;
  }
}

TEST(HumanLimbLengths, AreSumsOfBoneLengths) {
  HumanPose bones;
  const auto put = [&](const std::string& bone, double x, double y, double z) {
    bones[bone_from_name(bone).value()].translation = {x, y, z};
  };
  put("Hips", 0, 0, 1);
  put("Spine", 0, 0, 1.1);
  put("Spine1", 0.3, 0, 1.5);  // bent: 0.5 m long
  put("Spine2", 0.3, 0, 1.6);
  for (const auto& [side, y] : {std::pair<std::string, double>("Left", 0.1), {"Right", -0.1}}) {
    put(side + "UpLeg", 0, y, 1);
    put(side + "Leg", 0, y, 0.6);
    put(side + "Foot", 0.3, y, 0.2);
    put(side + "Arm", 0.3, 2 * y, 1.8);
    put(side + "ForeArm", 0.3, 5 * y, 1.8);
    put(side + "Hand", 0.5, 5 * y, 1.8);
  }
  const LimbLengths lengths = human_limb_lengths(bones);
  EXPECT_NEAR(lengths.leg, 0.4 + 0.5, 1e-12);
  EXPECT_NEAR(lengths.arm, 0.3 + 0.2, 1e-12);
  EXPECT_NEAR(lengths.trunk, 0.1 + 0.5 + 0.1 + 0.2, 1e-12);
}

}  // namespace
}  // namespace retarget
