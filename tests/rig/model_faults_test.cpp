// One model per fault: the message, and the repair.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "retarget/file.h"
#include "retarget/load_robot.h"
#include "retarget/rig.h"
#include "rig/model_faults.h"
#include "support/built_humanoids.h"
#include "support/temporary_folder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// All lengths a thousand or a hundred times larger.
BuiltHumanoid scaled(double factor) {
  return changed([&](BuiltHumanoid& built) {
    for (BuiltLimb* limb : {&built.leg, &built.arm}) {
      for (BuiltJoint& joint : limb->joints) joint.at *= factor;
      limb->end *= factor;
    }
  });
}

TEST_F(ModelFaults, AValidModelHasNone) {
  EXPECT_THAT(findings(plain_humanoid().mjcf(), true), ::testing::IsEmpty());
  EXPECT_THAT(notes(plain_humanoid().mjcf()), Not(Contains(HasSubstr("range"))));
}

TEST_F(ModelFaults, ReportOtherUnits) {
  expect_refused(scaled(1000.0).mjcf(), "millimetres; multiply its lengths by 0.001");
  expect_refused(scaled(100.0).mjcf(), "centimetres; multiply its lengths by 0.01");
}

TEST_F(ModelFaults, ReportRangesInTheOtherUnit) {
  std::string text = plain_humanoid().mjcf();
  replace_all(text, "angle=\"radian\"", "angle=\"degree\"");
  expect_refused(text, "add <compiler angle=\"radian\"/>");
  const BuiltHumanoid degrees = changed([](BuiltHumanoid& built) {
    for (BuiltLimb* limb : {&built.leg, &built.arm}) {
      for (BuiltJoint& joint : limb->joints) {
        joint.lower *= 57.3;
        joint.upper *= 57.3;
      }
    }
  });
  expect_refused(degrees.mjcf(), "rad, which looks like degrees");
}

TEST_F(ModelFaults, ReportMissingRanges) {
  expect_noted(changed([](BuiltHumanoid& built) {
                 built.arm.joints[2].lower = built.arm.joints[2].upper = 0.0;
               }).mjcf(),
               "and are unlimited: \"left_shoulder_yaw\", \"right_shoulder_yaw\"");
  std::string text = plain_humanoid().mjcf();
  replace_all(text, "range=\"-1 0.8\"", "");
  expect_noted(text, "and are unlimited: \"left_ankle_pitch\", \"right_ankle_pitch\"");
  text = plain_humanoid().mjcf();
  replace_all(text, "range=\"-1 0.8\"", "limited=\"true\" range=\"0.25 0.25\"");
  EXPECT_THAT(refusal(text), HasSubstr("ankle_pitch"));
  text = plain_humanoid().mjcf();
  replace_all(text, "range=\"-1 0.8\"", "range=\"nan 0.8\"");
  const auto made = make_robot(write(text), "robot");
  EXPECT_THAT(made ? made->notes : std::vector{made.error().message},
              Contains(HasSubstr("ankle_pitch")));
}

TEST_F(ModelFaults, LockJointsWhoseRangeIsASinglePosition) {
  const std::string text = changed([](BuiltHumanoid& built) {
                             built.waist = {{"waist", kAxisZ, {0, 0, 0}, 0.1, 0.1}};
                           }).mjcf();
  expect_noted(text, "the range of these joints is a single position: \"waist\"");
  EXPECT_THAT(notes(text), Not(Contains(HasSubstr("unlimited"))));
  const auto made = value_of(make_robot(write(text), "robot"));
  const auto robot = value_of(load_robot_files(folder_.write("made.xml", made.model)));
  const auto joint = static_cast<std::size_t>(robot->find_joint("waist").value());
  EXPECT_EQ(robot->model_limits().lower[joint], 0.1);
  EXPECT_EQ(robot->model_limits().upper[joint], 0.1);
}

// A body that moves needs a mass: its own or that of a body fixed to it.
TEST_F(ModelFaults, BodiesWithoutMassAreNamed) {
  const auto with_shoulder = [](const std::string& mass) {
    std::string text = plain_humanoid().mjcf();
    const std::size_t body = text.find("<body name=\"left_shoulder_roll\"");
    const std::size_t begin = text.find("<inertial", body);
    return text.replace(begin, text.find("/>", begin) + 2 - begin, mass);
  };
  const std::string words = "no mass of the moving bodies \"left_shoulder_roll\": replaced";
  const std::string inertia = " diaginertia=\"1e-2 1e-2 1e-2\"/>";
  expect_noted(with_shoulder(""), words);
  expect_noted(with_shoulder("<inertial pos=\"0 0 0\" mass=\"0\" diaginertia=\"0 0 0\"/>"), words);
  EXPECT_THAT(make_robot(write(with_shoulder("")), "robot")->decisions, HasSubstr(words));
  for (const std::string& mass :
       {"<inertial pos=\"0 0 0\" mass=\"1e-6\"" + inertia,
        "<body><inertial pos=\"0 0 0\" mass=\"1\"" + inertia + "</body>"}) {
    EXPECT_THAT(notes(with_shoulder(mass)), Not(Contains(HasSubstr("no mass"))));
  }
}

TEST_F(ModelFaults, ImpossibleInertiasAreNamed) {
  const auto with_torso = [](const std::string& inertial) {
    std::string text = plain_humanoid().mjcf();
    const std::size_t begin = text.find("<inertial", text.find("<body name=\"torso\""));
    return text.replace(begin, text.find("/>", begin) - begin,
                        "<inertial pos=\"0 0 0\" " + inertial);
  };
  expect_noted(with_torso("mass=\"1\" diaginertia=\"10 0.1 0.1\""),
               "impossible inertia of \"torso\": the largest moment exceeds the sum of the others");
  expect_noted(with_torso("mass=\"1\" diaginertia=\"0 0 0\""),
               "zero moments of inertia of \"torso\": replaced by a negligible value");
  for (const char* negative :
       {"mass=\"-1\" diaginertia=\"1 1 1\"", "mass=\"1\" diaginertia=\"1 -1 1\""}) {
    const std::string text = with_torso(negative);
    expect_noted(text, "invalid mass or inertia of \"torso\": replaced by a negligible value");
    EXPECT_THAT(notes(text), Not(Contains(HasSubstr("no mass"))));
  }
  EXPECT_THAT(notes(with_torso("mass=\"1\" diaginertia=\"1 1 2\"")),
              Not(Contains(HasSubstr("inertia"))));
}

TEST_F(ModelFaults, ReportDuplicateNames) {
  std::string text = plain_humanoid().mjcf();
  replace_all(text, "joint name=\"left_knee\"", "joint name=\"left_hip_yaw\"");
  EXPECT_THAT(refusal(text), HasSubstr("repeated name 'left_hip_yaw': two elements of kind joint"));
}

TEST_F(ModelFaults, SlidingRootsBecomeFreeJoints) {
  std::string text = changed([](BuiltHumanoid& built) {
                       built.root =
                           "<joint name=\"rootx\" type=\"slide\" axis=\"1 0 0\"/>"
                           "<joint name=\"rootz\" type=\"slide\" axis=\"0 0 1\"/>"
                           "<joint name=\"rooty\" axis=\"0 1 0\"/>";
                     }).mjcf();
  expect_noted(text, "the root moved by \"rootx\", \"rootz\", \"rooty\": a free joint");
  const auto made = value_of(make_robot(write(text), "robot"));
  EXPECT_EQ(made.model.find("rootx"), std::string::npos);
  // A free joint in parts, without names.
  text = changed([](BuiltHumanoid& built) {
           built.root =
               "<joint type=\"slide\" axis=\"1 0 0\"/><joint type=\"slide\" axis=\"0 1 0\"/>"
               "<joint type=\"slide\" axis=\"0 0 1\"/><joint type=\"ball\"/>";
         }).mjcf();
  expect_noted(text,
               "the root moved by \"joint_1\", \"joint_2\", \"joint_3\", \"joint_4\": a free");
  // Each in a separate body.
  const std::string mass = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>";
  text = plain_humanoid().mjcf();
  replace_all(text, "<freejoint/>", "<joint name=\"rooty\" axis=\"0 1 0\"/>");
  replace_all(text, "<worldbody>",
              "<worldbody><body name=\"cart\">" + mass +
                  "<joint name=\"rootx\" type=\"slide\" axis=\"1 0 0\"/>");
  replace_all(text, "</worldbody>", "</body></worldbody>");
  expect_noted(text, "the root moved by \"rootx\", \"rooty\": a free joint");
}

TEST_F(ModelFaults, ReportLeaningAndObliqueTrunks) {
  const auto turned = [](const std::string& euler) {
    return changed([&](BuiltHumanoid& built) {
             built.before = "<compiler eulerseq=\"xyz\"/>";
             built.pelvis = "pos=\"0 0 1\" euler=\"" + euler + "\"";
           })
        .mjcf();
  };
  expect_noted(turned("0 0.52 0"), "the trunk leans by 30 degrees");
  expect_noted(turned("0 0 0.52"), "oblique to the axes");
  expect_refused(turned("0 1.5 0"), "does not stand upright");
}

// The H1's joint axes pair its limbs partly when it stands along y.
TEST_F(ModelFaults, ReportOtherUprightAxes) {
  const auto model = value_of(read_file(
      std::string(RETARGET_SOURCE_DIR) + "/robots/unitree_h1/model.xml", ErrorKind::kConfig));
  for (const char* turn : {"-0.70710678 0 0", "0.70710678 0 0", "0 0.70710678 0"}) {
    std::string text(model.view());
    replace_all(text, "<body name=\"pelvis\" pos=\"0 0 1.1\">",
                fmt::format("<body name=\"pelvis\" quat=\"0.70710678 {}\">", turn));
    expect_refused(text, "does not stand upright along z");
    EXPECT_THAT(refusal(text), HasSubstr("turn its root body"));
  }
}

TEST_F(ModelFaults, WarnAboutUnusualSegmentLengths) {
  // A joint that rotates the forearm, a third of an upper arm beyond the elbow, without any other
  // joint there.
  const std::string text = changed([](BuiltHumanoid& built) {
                             built.arm.joints.push_back({"twist", kAxisZ, {0, 0, -0.06}});
                             built.arm.end = {0, 0, 0};
                             built.arm.marked = false;
                             built.arm.heavy = false;
                           }).mjcf();
  expect_noted(
      text,
      "the left forearm is 0.33 as long as the left upper arm: is \"left_elbow\" the left elbow?");
}

TEST_F(ModelFaults, TrunksThatLeanFarNeedClearLimbs) {
  const auto leaning = [](bool clear) {
    return changed([&](BuiltHumanoid& built) {
             built.shoulder = {0.45, 0.15, 0.4};
             if (clear) return;
             built.arm.joints.push_back({"twist", kAxisZ, {0, 0, -0.06}});
             built.arm.end = {0, 0, 0};
             built.arm.marked = false;
             built.arm.heavy = false;
           })
        .mjcf();
  };
  expect_noted(leaning(true), "the trunk leans by 45 degrees");
  expect_refused(leaning(false),
                 "the trunk leans by 45 degrees in the zero configuration, and the left forearm");
}

TEST_F(ModelFaults, RejectDistantTPoses) {
  // The outstretched arm lacks 30 degrees.
  expect_refused(changed([](BuiltHumanoid& built) {
                   built.arm.joints[1].upper = 1.05;
                   built.arm.joints[0].lower = -0.3;
                   built.arm.joints[0].upper = 0.3;
                 }).mjcf(),
                 "the T-pose cannot be reached: \"left_shoulder_yaw\" (LeftArm) stays");
}

TEST_F(ModelFaults, ReportUnreachableTPoses) {
  expect_refused(changed([](BuiltHumanoid& built) {
                   built.arm.joints[1].lower = -0.1;
                   built.arm.joints[1].upper = 0.1;
                   built.arm.joints[0].lower = -0.3;
                   built.arm.joints[0].upper = 0.3;
                 }).mjcf(),
                 "the T-pose cannot be reached: \"left_shoulder_yaw\" (LeftArm)");
}

TEST_F(ModelFaults, RejectTemplatesAndMissingIncludes) {
  EXPECT_THAT(refusal("<robot name=\"a\" xmlns:xacro=\"http://ros.org/wiki/xacro\">"
                      "<xacro:include filename=\"b.xacro\"/><link name=\"base\"/></robot>",
                      "robot.urdf.xacro"),
              HasSubstr("xacro robot.urdf.xacro > robot.urdf"));
  EXPECT_THAT(refusal("<robot name=\"a\"><link name=\"${prefix}base\"/></robot>", "robot.urdf"),
              HasSubstr("which xacro must substitute"));
  EXPECT_THAT(refusal("<mujoco><include file=\"arms.xml\"/></mujoco>"),
              HasSubstr("<include> names \"arms.xml\", which does not exist"));
}

TEST_F(ModelFaults, IgnoreSimulatorExtensionsInAUrdf) {
  const std::string text =
      "<robot name=\"a\"><link name=\"base\"/><gazebo><plugin filename=\"x.so\" name=\"${x}\"/>"
      "</gazebo></robot>";
  EXPECT_THAT(refusal(text, "robot.urdf"), Not(HasSubstr("plugin")));
}

TEST_F(ModelFaults, DummyBodiesDoNotStopAModel) {
  std::string text = changed([](BuiltHumanoid& built) {
                       built.leg.more += "<body><joint type=\"ball\"/><geom size=\"0.01\"/></body>";
                     }).mjcf();
  expect_noted(text, "ball joints that move nothing else are locked");
  text = plain_humanoid().mjcf();
  replace_all(text, "<body name=\"torso\">",
              "<body name=\"torso\"><body name=\"imu\"><inertial pos=\"0 0 0\" mass=\"0.1\" "
              "fullinertia=\"-1 1 1 0 0 0\"/></body>");
  EXPECT_TRUE(make_robot(write(text), "robot"));
  EXPECT_THAT(findings(text, false), Contains(HasSubstr("mass or inertia of \"imu\"")));
  // A rod next to the shin, tied to the foot.
  const std::string rod =
      "<body name=\"left_knee_rod\"><joint name=\"rod\" axis=\"0 1 0\" range=\"-1 1\"/>"
      "<geom size=\"0.01\"/></body>";
  text = plain_humanoid().mjcf();
  replace_all(text, "<body name=\"left_ankle_pitch\"", rod + "<body name=\"left_ankle_pitch\"");
  replace_all(text, "</mujoco>",
              "<equality><connect body1=\"left_knee_rod\" body2=\"left_ankle_roll\" "
              "anchor=\"0 0 0\"/></equality></mujoco>");
  expect_noted(text, "\"left_knee_rod\" does not follow");
  // Without a rod, the leg is the closed chain.
  replace_all(text, "body1=\"left_knee_rod\"", "body1=\"left_knee\"");
  expect_refused(text, "closed chain");
}

TEST_F(ModelFaults, DoesNotMistakeToesForFeet) {
  const auto said =
      notes(changed([](BuiltHumanoid& built) {
              built.leg.joints.push_back({"toe", kAxisY, {0.09, 0, -0.04}, -0.3, 0.6});
            }).mjcf());
  EXPECT_THAT(said, Contains(HasSubstr("\"left_toe\" is assumed to be a toe")));
}

}  // namespace
}  // namespace retarget
