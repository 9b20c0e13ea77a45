#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "human/expect_bones.h"
#include "human/tiny_skeleton.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

TEST(Recognise, LegBelowUpLegIsTheShin) {
  expect_bones(kBody, {{"LeftUpLeg", "LeftUpLeg"},
                       {"LeftLeg", "LeftLeg"},
                       {"LeftFoot", "LeftFoot"},
                       {"LeftShoulder", "LeftShoulder"},
                       {"LeftArm", "LeftArm"},
                       {"LeftForeArm", "LeftForeArm"}});
}

TEST(Recognise, LegAboveShinIsTheThigh) {
  const std::string body = renamed({{"LeftLeg", "LeftShin"},
                                    {"RightLeg", "RightShin"},
                                    {"UpLeg", "Leg"},
                                    {"Spine2", "Chest"},
                                    {"Spine1", "Spine2"},
                                    {"Spine ", "Spine1 "}});
  expect_bones(body, {{"LeftUpLeg", "LeftLeg"}, {"LeftLeg", "LeftShin"}, {"Spine2", "Chest"}});
}

TEST(Recognise, ShoulderBelowCollarIsTheUpperArm) {
  const std::string body = renamed({{"Shoulder", "Collar"},
                                    {"LeftArm", "LeftShoulder"},
                                    {"RightArm", "RightShoulder"},
                                    {"ForeArm", "Elbow"},
                                    {"Hand", "Wrist"},
                                    {"UpLeg", "Hip"},
                                    {"Leg", "Knee"},
                                    {"Foot", "Ankle"},
                                    {"ToeBase", "Toe"}});
  expect_bones(body, {{"LeftShoulder", "LeftCollar"},
                      {"LeftArm", "LeftShoulder"},
                      {"LeftForeArm", "LeftElbow"},
                      {"LeftHand", "LeftWrist"},
                      {"LeftUpLeg", "LeftHip"},
                      {"LeftFoot", "LeftAnkle"},
                      {"LeftToe", "LeftToe"}});
}

TEST(Recognise, ShoulderIsTheUpperArmIfThereIsNoOther) {
  const Skeleton skeleton = tiny_skeleton(R"(
Hips 0 90 0
  LeftHip 10 -2 0
    LeftKnee 0 -42 0
      LeftAnkle 0 -41 0
  RightHip -10 -2 0
    RightKnee 0 -42 0
      RightAnkle 0 -41 0
  Chest 0 20 0
    Head 0 35 0
    LeftShoulder 17 18 0
      LeftElbow 29 0 0
        LeftWrist 25 0 0
    RightShoulder -17 18 0
      RightElbow -29 0 0
        RightWrist -25 0 0
)");
  const auto map = value_of(recognise(skeleton));
  EXPECT_EQ(joint_name(map, skeleton, "LeftArm"), "LeftShoulder");
  EXPECT_EQ(joint_name(map, skeleton, "LeftShoulder"), "");
  EXPECT_EQ(joint_name(map, skeleton, "Neck"), "");
  EXPECT_EQ(joint_name(map, skeleton, "Head"), "Head");
  EXPECT_THAT(map.notes,
              Contains(HasSubstr("not in the source: LeftToe, RightToe, Spine, Spine1, Neck, "
                                 "LeftShoulder, RightShoulder")));
}

TEST(Recognise, ZeroLengthHelpersAreNotLimbs) {
  const std::string body = R"(
Hips 0 0 0
  LHipJoint 0 0 0
    LeftUpLeg 2.1 -1.6 1.1
      LeftLeg 2.0 -5.6 0
        LeftFoot 2.7 -7.5 0
          LeftToeBase 0.1 -0.25 2
            end 0 0 1
  RHipJoint 0 0 0
    RightUpLeg -2.1 -1.6 1.1
      RightLeg -2.0 -5.6 0
        RightFoot -2.7 -7.5 0
          RightToeBase -0.1 -0.25 2
            end 0 0 1
  LowerBack 0 0 0
    Spine 0 1.8 -0.3
      Spine1 0 1.9 0.15
        Neck 0 0 0
          Neck1 0 1.8 0.1
            Head 0 1.8 -0.3
              end 0 1.8 0
        LeftShoulder 0 0 0
          LeftArm 3.6 0.8 -0.4
            LeftForeArm 4.9 0 0
              LeftHand 2.7 0 0
                LeftFingerBase 0 0 0
                  LeftHandIndex1 0.7 0 0
                LThumb 0 0 0
        RightShoulder 0 0 0
          RightArm -3.6 0.8 -0.4
            RightForeArm -4.9 0 0
              RightHand -2.7 0 0
                RightFingerBase 0 0 0
                  RightHandIndex1 -0.7 0 0
                RThumb 0 0 0
)";
  expect_bones(body, {{"Hips", "Hips"},
                      {"LeftUpLeg", "LeftUpLeg"},
                      {"RightUpLeg", "RightUpLeg"},
                      {"Spine", "LowerBack"},
                      {"Spine1", "Spine"},
                      {"Spine2", "Spine1"},
                      {"Neck", "Neck1"},
                      {"LeftHand", "LeftHand"}});
}

TEST(Recognise, FingersAreNotHands) {
  std::string body = kBody;
  for (const std::string side : {"Left", "Right"}) {
    const std::string x = side == "Left" ? "15" : "-15";
    body = replaced(body, "                end " + x + " 0 0\n",
                    "                " + side + "InHandIndex 3 0 1\n                  " + side +
                        "HandIndex1 5 0 0\n                " + side +
                        "HandThumb1 2 0 3\n                " + side + "lnHandMiddle 3 0 0\n");
  }
  expect_bones(body, {{"LeftHand", "LeftHand"}, {"RightHand", "RightHand"}});
}

TEST(Recognise, SkipsTwistJoints) {
  std::string body = R"(
pelvis 0 90 0
  thigh_l 10 -2 0
    thigh_twist_01_l 0 -20 0
    calf_l 0 -42 0.5
      foot_l 0 -41 -0.5
        ball_l 0 -6 13
  thigh_r -10 -2 0
    thigh_twist_01_r 0 -20 0
    calf_r 0 -42 0.5
      foot_r 0 -41 -0.5
        ball_r 0 -6 13
  spine_01 0 10 0
    spine_02 0 20 0
      neck_01 0 26 0
        head 0 11 0
      clavicle_l 5 18 0
        upperarm_l 12 0 0
          upperarm_twist_01_l 10 0 0
          roll_l 14 0 0
            lowerarm_l 15 0 0
              hand_l 25 0 0
      clavicle_r -5 18 0
        upperarm_r -12 0 0
          upperarm_twist_01_r -10 0 0
          roll_r -14 0 0
            lowerarm_r -15 0 0
              hand_r -25 0 0
)";
  expect_bones(body, {{"LeftUpLeg", "thigh_l"},
                      {"LeftLeg", "calf_l"},
                      {"LeftArm", "upperarm_l"},
                      {"LeftForeArm", "lowerarm_l"},
                      {"RightHand", "hand_r"}});
  // The same result with evidence from the shape alone.
  const Skeleton skeleton = tiny_skeleton(body);
  const auto map = value_of(recognise(with_names(skeleton, meaningless_names(skeleton))));
  EXPECT_EQ(joint_name(map, skeleton, "LeftLeg"), "calf_l");
  EXPECT_EQ(joint_name(map, skeleton, "LeftForeArm"), "lowerarm_l");
}

}  // namespace
}  // namespace retarget
