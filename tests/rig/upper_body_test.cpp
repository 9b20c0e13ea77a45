// Robots with a fixed base: an upper body on a stand or on wheels.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "limb_errors.h"
#include "retarget/human.h"
#include "retarget/load.h"
#include "retarget/plan.h"
#include "retarget/report.h"
#include "retarget/rig.h"
#include "retarget/solve.h"
#include "robot/anatomy/limbs.h"
#include "solve/robot_setup/check_robot.h"
#include "support/angles.h"
#include "support/humanoids.h"
#include "support/value_of.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// Trunk and arms of tiny_humanoid on a two-wheeled cart, which is part of the world.
std::string body_on_cart(const std::string& placed, bool with_waist) {
  const std::string whole = tiny_humanoid(true);
  const std::string mass = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>";
  std::string wheels;
  for (const std::string side : {"left", "right"}) {
    wheels += "<body name=\"" + side + "_wheel\" pos=\"0 " + (side == "left" ? "0.2" : "-0.2") +
              " -0.5\">" + mass + "<joint name=\"" + side + "_wheel\" axis=\"0 1 0\"/></body>";
  }
  std::string trunk = whole.substr(whole.find("<body name=\"torso\""));
  if (!with_waist) {
    const std::size_t waist = trunk.find("<joint name=\"waist\"");
    trunk.erase(waist, trunk.find("/>", waist) + 2 - waist);
  }
  return "<mujoco><compiler angle=\"radian\"/><worldbody><body name=\"cart\" " + placed + ">" +
         mass + wheels + trunk;
}

class UpperBodyTest : public testing::Test {
 protected:
  // The folder of a robot made from a model.
  std::string made(const std::string& name, const std::string& text, RobotBase base) {
    const auto robot = value_of(make_robot(folder_.write(name + ".xml", text), name, base));
    return value_of(save_robot(robot, folder_.path(), true)).string();
  }

  static Motion solved(const std::string& robot, const std::string& clip, Method method) {
    RobotChoice choice;
    choice.name = robot;
    Options options;
    options.solve.method = method;
    const auto data = fs::path(RETARGET_SOURCE_DIR) / "data" / (clip + ".bvh");
    auto plan =
        value_of(make_plan(load_clip(data.string()).value(), load_robot(choice).value(), options));
    return value_of(solve(std::move(plan)));
  }

  // The human turned so that the line between its hips faces along x, then by `yaw`: the expected
  // pose of a robot with a fixed base.
  static HumanClip facing(HumanClip human, double yaw) {
    for (HumanPose& pose : human.world_from_bone) {
      const Eigen::Vector3d left =
          pose[Bone::kLeftUpLeg].translation - pose[Bone::kRightUpLeg].translation;
      const double heading = std::atan2(-left.x(), left.y());
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw - heading, Eigen::Vector3d::UnitZ()));
      for (const Bone bone : kAllBones) {
        pose[bone] = {turn * pose[bone].rotation, turn * pose[bone].translation};
      }
    }
    return human;
  }

  // Angle between the robot's and the human's upper arms and forearms, degrees.
  static double arm_error(const HumanClip& human, const Motion& motion) {
    const Robot& robot = motion.clip.robot();
    const auto limbs = value_of(find_limbs(robot, "robot"));
    double sum = 0.0;
    for (const LimbError& error : limb_errors(human, motion.clip, limbs)) {
      if (error.segment.find("arm") != std::string::npos) sum += 0.25 * error.mean;
    }
    return sum * kDegrees;
  }

  static HumanClip human_of(const Motion& motion) {
    return to_human(*motion.source, motion.plan.human.calibration);
  }

  static void expect_base_stands(const RobotClip& clip) {
    const std::vector<double> zero = clip.robot().zero_configuration();
    double moved = 0.0;
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      for (std::size_t i = 0; i < 7; ++i) {
        moved = std::max(moved, std::abs(clip.qpos(frame)[i] - zero[i]));
      }
    }
    EXPECT_LT(moved, 1e-12);
  }

  TemporaryFolder folder_;
};

TEST_F(UpperBodyTest, RequiresAFixedBase) {
  const std::string model = folder_.write("cart.xml", body_on_cart("pos=\"0 0 0.6\"", true));
  const auto refused = make_robot(model, "cart");
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, HasSubstr("two legs and two arms"));
  EXPECT_THAT(refused.error().hint, HasSubstr("fixed"));
  const auto made = value_of(make_robot(model, "cart", RobotBase::kFixed));
  EXPECT_THAT(made.profile, HasSubstr("\"base\": \"fixed\""));
  const auto folder = value_of(save_robot(made, folder_.path(), false));
  const RobotSources sources{"cart",
                             (folder / "model.xml").string(),
                             (folder / "robot.json").string(),
                             (folder / "ik.json").string(),
                             {}};
  const auto findings = value_of(check_robot(sources));
  for (const RobotFinding& finding : findings) {
    EXPECT_FALSE(finding.fault) << finding.text;
    EXPECT_THAT(finding.text, testing::Not(HasSubstr("sole")));
  }
}

// Joints without ranges, so that legs could reach a T-pose.
TEST_F(UpperBodyTest, RejectsLegs) {
  const auto legs = [](const std::string& names, const std::string& x) {
    std::string text;
    for (const std::string side : {"left", "right"}) {
      const std::string name = side + names, y = side == "left" ? "0.1" : "-0.1";
      const auto body = [&](const std::string& part, const std::string& at,
                            const std::string& axis) {
        return "<body name=\"" + name + part + "\" pos=\"" + at +
               "\"><inertial pos=\"0 0 -0.1\" mass=\"1\" diaginertia=\"1 1 1\"/><joint name=\"" +
               name + part + "\" axis=\"" + axis + "\"/>";
      };
      text += body("hip_roll", x + " " + y + " 0", "1 0 0") + body("hip_pitch", "0 0 0", "0 1 0") +
              body("knee", "0 0 -0.3", "0 1 0") +
              "<body pos=\"0 0 -0.3\"><inertial pos=\"0 0 0\" mass=\"0.1\" diaginertia=\"1 1 "
              "1\"/></body>"
              "</body></body></body>";
    }
    return text;
  };
  const auto refusal = [&](const std::string& limbs) {
    const std::string model = folder_.write(
        "legs.xml",
        "<mujoco><worldbody><body name=\"base\" pos=\"0 0 0.7\"><inertial pos=\"0 0 0\" mass=\"9\" "
        "diaginertia=\"1 1 1\"/>" +
            limbs + "</body></worldbody></mujoco>");
    const auto made = make_robot(model, "legs", RobotBase::kFixed);
    EXPECT_FALSE(made.has_value());
    return made ? std::string() : made.error().message;
  };
  EXPECT_THAT(refusal(legs("_", "0")), HasSubstr("have the names of legs"));
  EXPECT_THAT(refusal(legs("_front_", "0.2") + legs("_rear_", "-0.2")), HasSubstr("a quadruped"));
}

TEST_F(UpperBodyTest, ArmsFollowAsOnAFloatingBaseAndTheBaseIsFixed) {
  const std::string whole = made("whole", tiny_humanoid(true), RobotBase::kAuto);
  const std::string cart = made("cart", body_on_cart("pos=\"0 0 0.6\"", true), RobotBase::kFixed);
  for (const Method method : {Method::kGmr, Method::kFit}) {
    for (const std::string clip : {"wave", "turn_in_place"}) {
      const Motion moving = solved(whole, clip, method);
      const Motion standing = solved(cart, clip, method);
      const HumanClip human = human_of(standing);
      const double error = arm_error(facing(human, 0.0), standing);
      EXPECT_LT(error, arm_error(human, moving) + 1.0) << clip;
      EXPECT_LT(error, 6.0) << clip;
      expect_base_stands(standing.clip);
    }
  }
}

TEST_F(UpperBodyTest, KeepsPositionAndHeadingOfTheBase) {
  const std::string turned =
      made("turned", body_on_cart("pos=\"1 -2 0.6\" quat=\"0.70710678 0 0 0.70710678\"", true),
           RobotBase::kFixed);
  const Motion motion = solved(turned, "turn_in_place", Method::kFit);
  expect_base_stands(motion.clip);
  EXPECT_NEAR(motion.clip.qpos(0)[0], 1.0, 1e-9);
  EXPECT_LT(arm_error(facing(human_of(motion), 0.5 * std::numbers::pi), motion), 6.0);
}

TEST_F(UpperBodyTest, ArmsAreRelativeToAChestBase) {
  const std::string chest =
      made("chest", body_on_cart("pos=\"0 0 0.6\"", false), RobotBase::kFixed);
  const Motion motion = solved(chest, "get_up", Method::kFit);
  expect_base_stands(motion.clip);
  // The human lies down and gets up; only relative to the robot is its chest upright.
  HumanClip human = human_of(motion);
  const auto standing = human.frame(human.frame_count - 1)[Bone::kSpine2].rotation;
  const HumanPose& last = human.frame(human.frame_count - 1);
  const Eigen::Vector3d left =
      last[Bone::kLeftUpLeg].translation - last[Bone::kRightUpLeg].translation;
  const Eigen::Quaterniond ahead(
      Eigen::AngleAxisd(-std::atan2(-left.x(), left.y()), Eigen::Vector3d::UnitZ()));
  for (HumanPose& pose : human.world_from_bone) {
    const Eigen::Quaterniond turn = ahead * standing * pose[Bone::kSpine2].rotation.conjugate();
    for (const Bone bone : kAllBones) pose[bone].translation = turn * pose[bone].translation;
  }
  EXPECT_LT(arm_error(human, motion), 12.0);
}

TEST_F(UpperBodyTest, IsMeasuredWithoutFloorAndFeet) {
  const std::string cart = made("cart", body_on_cart("pos=\"0 0 0.6\"", true), RobotBase::kFixed);
  const auto report = value_of(evaluate(solved(cart, "turn_in_place", Method::kFit)));
  for (const char* metric : {"foot_pen_1cm_pct", "body_pen_1cm_pct", "float_2cm_pct",
                             "contact_slip_mean", "stance_slip_mean", "lying_pct"}) {
    EXPECT_EQ(report.find(metric), nullptr) << metric;
  }
  ASSERT_NE(report.find("limb_angle_deg"), nullptr);
  EXPECT_LT(report.find("limb_angle_deg")->value, 6.0);
}

TEST_F(UpperBodyTest, AModelWithoutFreeJointRequiresAFixedBase) {
  RobotChoice choice;
  choice.model = folder_.write("cart.xml", body_on_cart("pos=\"0 0 0.6\"", true));
  const auto refused = load_robot(choice);
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, HasSubstr("no free joint"));
  choice.base = RobotBase::kFixed;
  const auto robot = value_of(load_robot(choice));
  EXPECT_TRUE(robot.robot->fixed_base());
  EXPECT_TRUE(robot.robot->profile().soles.empty());
}

}  // namespace
}  // namespace retarget
