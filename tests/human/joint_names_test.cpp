#include "human/skeleton/joint_names.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

JointName normalised(const std::string& name) {
  return normalise_joint_names({name})[0];
}

TEST(JointNames, FindsSidesAnywhereInTheName) {
  const JointName thigh{Side::kLeft, "thigh"};
  for (const char* name : {"LeftThigh", "left_thigh", "thigh_l", "L_Thigh", "Thigh.L", "lThigh",
                           "Bip01 L Thigh", "Left Thigh", "ValveBiped.Bip01_L_Thigh", "lthigh",
                           "CC_Base_L_Thigh", "Rig:LeftThigh", "Armature|Left-Thigh", "LThigh"}) {
    EXPECT_EQ(normalised(name), thigh) << name;
  }
  EXPECT_EQ(normalised("RUArm"), (JointName{Side::kRight, "uarm"}));
  EXPECT_EQ(normalised("rradius"), (JointName{Side::kRight, "radius"}));
  EXPECT_EQ(normalised("\xE5\xB7\xA6\xE8\xB6\xB3"), (JointName{Side::kLeft, "\xE8\xB6\xB3"}));
}

TEST(JointNames, IgnoresWordsThatStartLikeASide) {
  for (const char* name : {"root", "lowerback", "L5", "Reference", "LowerNeck", "ribs"}) {
    EXPECT_EQ(normalised(name).side, Side::kNone) << name;
  }
}

TEST(JointNames, DropsMiddleMarks) {
  for (const char* name :
       {"J_Bip_C_Head", "C_Head", "Head_C", "head.c", "Center Head", "HeadCtr", "Bip01 C Head"}) {
    EXPECT_EQ(normalised(name), (JointName{Side::kNone, "head"})) << name;
  }
  EXPECT_EQ(normalised("J_Bip_L_UpperLeg"), (JointName{Side::kLeft, "upperleg"}));
  EXPECT_EQ(normalised("C7").base, "c7");
}

TEST(JointNames, NormalisesNumbersAndSeparators) {
  for (const char* name : {"Spine1", "spine_01", "Spine-1", "SPINE 1", "mixamorig1:Spine1"}) {
    EXPECT_EQ(normalised(name), (JointName{Side::kNone, "spine1"})) << name;
  }
}

TEST(JointNames, DropsCommonWords) {
  const auto names =
      normalise_joint_names({"Actor_Hips.L-x", "Actor_Spine.L-x", "Actor_LeftArm.L-x",
                             "Actor_RightArm.L-x", "Actor_Head.L-x", "Actor_Neck.L-x"});
  EXPECT_EQ(names[0], (JointName{Side::kNone, "hips"}));
  EXPECT_EQ(names[3], (JointName{Side::kRight, "arm"}));
  // A few names prove nothing.
  EXPECT_EQ(normalise_joint_names({"Actor_Hips", "Actor_Head"})[0].base, "actorhips");
}

TEST(BodyWords, AmbiguousWordsMatchBothParts) {
  EXPECT_EQ(meanings_of(normalised("LeftShoulder")).size(), 2U);
  EXPECT_EQ(meanings_of(normalised("LeftLeg")).size(), 2U);
  EXPECT_EQ(meanings_of(normalised("LeftUpLeg")).size(), 1U);
}

TEST(BodyWords, IgnoresFingersTwistsAndEnds) {
  for (const char* name : {"LeftHandIndex1", "LeftInHandIndex", "RightlnHandMiddle", "LHipJoint",
                           "LeftForeArmRoll", "upperarm_twist_01_l", "HeadTop_End", "LeftToe_End",
                           "LeftFingerBase", "LeftEye", "lButtock"}) {
    EXPECT_TRUE(meanings_of(normalised(name)).empty()) << name;
  }
}

TEST(BodyWords, CanonicalNamesMatchTheirBones) {
  EXPECT_TRUE(may_mean(normalised("lShin"), Bone::kLeftLeg));
  EXPECT_FALSE(may_mean(normalised("rShin"), Bone::kLeftLeg));
  EXPECT_FALSE(may_mean(normalised("LeftThigh"), Bone::kLeftLeg));
  EXPECT_TRUE(may_mean(normalised("Chest"), Bone::kSpine2));
  EXPECT_TRUE(may_mean(normalised("LeftCollar"), Bone::kLeftShoulder));
}

}  // namespace
}  // namespace retarget
