#include "base/option_name.h"
#include "human/skeleton/candidate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "human/skeleton/recognise.h"
#include "human/tiny_skeleton.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Result<BoneMap> by_names(const std::string& body) {
  return recognise_skeleton(tiny_skeleton(body), {});
}

// The lines of a body, each transformed by `change`.
template <typename Change>
std::string with_lines(const std::string& body, const Change& change) {
  std::string result;
  std::istringstream lines(body);
  for (std::string line; std::getline(lines, line);) result += change(line);
  return result;
}

TEST(LimbSearch, RejectsDuplicatesOfRequiredBones) {
  // A second forearm with its own hand.
  const std::string body = replaced(kBody, "            LeftForeArm 29 0 0\n",
                                    "            LeftElbow 29 0 0\n              LeftWrist 25 0 0\n"
                                    "            LeftForeArm 29 0 0\n");
  const auto map = by_names(body);
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error().message, HasSubstr("\"LeftForeArm\""));
  EXPECT_THAT(map.error().hint, HasSubstr(OPTION("map")));
}

// A hand and a wrist at one position, two toe joints side by side, a head and a skull.
TEST(LimbSearch, ChoosesAmongDuplicatesOfOptionalBones) {
  const std::string body = with_lines(kBody, [](const std::string& line) {
    std::string twin = line;
    for (const auto& [from, to] :
         {std::pair("Hand 2", "Wrist 2"), {"Hand -2", "Wrist -2"}, {"Head", "Skull"}}) {
      twin = replaced(twin, from, to);
    }
    if (twin != line) return twin + "\n" + line + "\n";
    if (line.find("ToeBase") == std::string::npos) return line + "\n";
    return replaced(replaced(line, "ToeBase", "Toe"), " 0 -6", " 2 -6") + "\n" +
           replaced(line, " 0 -6", " -2 -6") + "\n";
  });
  const Skeleton skeleton = tiny_skeleton(body);
  const auto map = value_of(by_names(body));
  EXPECT_EQ(map.profile, "names");
  for (const char* bone : {"LeftToe", "RightToe", "LeftHand", "RightHand", "Head"}) {
    EXPECT_GE(map.joint(bone_from_name(bone).value()), 0) << bone;
    EXPECT_THAT(map.notes, Contains(HasSubstr("could each be the " + std::string(bone)))) << bone;
  }
  EXPECT_EQ(joint_name(map, skeleton, "LeftToe").substr(4),
            joint_name(map, skeleton, "RightToe").substr(5));
}

TEST(LimbSearch, UsesTheMiddleToe) {
  const std::string body = with_lines(kBody, [](const std::string& line) {
    if (line.find("ToeBase") == std::string::npos) return line + "\n";
    std::string toes;
    for (int toe = 1; toe <= 5; ++toe) {
      const std::string name = "Toe" + std::to_string(toe);
      toes += replaced(replaced(line, "ToeBase", name), " 0 -6",
                       " " + std::to_string(toe - 3) + " -6") +
              "\n";
      toes += "  " + replaced(replaced(line, "ToeBase", name + "-2"), "-6 13", "0 2") + "\n";
    }
    return toes;
  });
  const auto map = value_of(by_names(body));
  EXPECT_EQ(joint_name(map, tiny_skeleton(body), "LeftToe"), "LeftToe3");
  EXPECT_EQ(joint_name(map, tiny_skeleton(body), "RightToe"), "RightToe3");
}

TEST(LimbSearch, OmitsAToeWithADuplicateName) {
  const std::string body = with_lines(kBody, [](const std::string& line) {
    return line.find("LeftToeBase") == std::string::npos ? line + "\n" : line + "\n" + line + "\n";
  });
  for (const auto& profiles : {shipped_profiles(), std::vector<SkeletonProfile>()}) {
    const auto map = value_of(recognise_skeleton(tiny_skeleton(body), profiles));
    EXPECT_EQ(map.joint(Bone::kLeftToe), -1);
    EXPECT_GE(map.joint(Bone::kRightToe), 0);
    EXPECT_THAT(map.notes, Contains(HasSubstr("2 joints are called \"LeftToeBase\"")));
  }
}

// MakeHuman's default rig: every limb segment in two joints, and five toes.
std::string makehuman_body() {
  std::string body = R"(
root 0 9 0
)";
  for (const std::string side : {"L", "R"}) {
    const std::string sign = side == "L" ? "" : "-";
    std::string leg =
        "  pelvis.# 0.5 -0.2 0\n"
        "    upperleg01.# 0.6 0 0\n"
        "      upperleg02.# 0 -2.1 0\n"
        "        lowerleg01.# 0 -2.1 0.05\n"
        "          lowerleg02.# 0 -2 0\n"
        "            foot.# 0 -2.1 -0.05\n";
    for (int toe = 1; toe <= 5; ++toe) {
      const std::string name = "toe" + std::to_string(toe);
      leg += "              " + name + "-1.# 0." + std::to_string(9 - toe) + " -0.7 1.3\n" +
             "                " + name + "-2.# 0 0 0.3\n";
    }
    leg = replaced(replaced(leg, "#", side), ".# 0.", ".# " + sign + "0.");
    body += side == "L" ? leg : replaced(replaced(leg, " 0.", " -0."), "-0.05", "0.05");
  }
  body +=
      "  spine05 0 0.6 0\n    spine04 0 0.8 0\n      spine03 0 0.8 0\n        spine02 0 0.8 0\n"
      "          spine01 0 0.8 0\n";
  for (const std::string side : {"L", "R"}) {
    std::string arm =
        "            clavicle.# +0.2 1 0\n"
        "              shoulder01.# +0.7 0.1 0\n"
        "                upperarm01.# +0.8 0 0\n"
        "                  upperarm02.# +1.3 0 0\n"
        "                    lowerarm01.# +1.5 0 0\n"
        "                      lowerarm02.# +1.2 0 0\n"
        "                        wrist.# +1.3 0 0\n";
    body += replaced(replaced(arm, "#", side), "+", side == "L" ? "" : "-");
  }
  return body +
         "            neck01 0 1.3 0\n              neck02 0 0.4 0\n                neck03 0 0.4 "
         "0\n"
         "                  head 0 0.4 0\n";
}

TEST(LimbSearch, SplitSegmentUsesItsUpperJoint) {
  const Skeleton skeleton = tiny_skeleton(makehuman_body());
  for (const auto& profiles : {shipped_profiles(), std::vector<SkeletonProfile>()}) {
    const auto map = value_of(recognise_skeleton(skeleton, profiles));
    EXPECT_EQ(map.profile, profiles.empty() ? "names" : "makehuman_default");
    for (const auto& [bone, joint] :
         std::vector<std::pair<const char*, const char*>>{{"Hips", "root"},
                                                          {"LeftUpLeg", "upperleg01.L"},
                                                          {"LeftLeg", "lowerleg01.L"},
                                                          {"LeftFoot", "foot.L"},
                                                          {"Spine", "spine05"},
                                                          {"Spine2", "spine01"},
                                                          {"Neck", "neck01"},
                                                          {"Head", "head"},
                                                          {"RightShoulder", "clavicle.R"},
                                                          {"RightArm", "upperarm01.R"},
                                                          {"RightForeArm", "lowerarm01.R"},
                                                          {"RightHand", "wrist.R"}}) {
      EXPECT_EQ(joint_name(map, skeleton, bone), joint) << bone << " by " << map.profile;
    }
    EXPECT_THAT(map.notes, Contains(HasSubstr("folded into the limbs: \"upperleg02.L\"")));
  }
  // leg1 and leg2 are thigh and shin, not two parts of a thigh.
  const auto map = by_names(
      replaced(replaced(replaced(replaced(kBody, "LeftLeg", "LeftLeg2"), "RightLeg", "RightLeg2"),
                        "UpLeg", "Leg1"),
               "Spine ", "Spine0 "));
  ASSERT_TRUE(map) << describe(map.error());
}

// The body without the forearm of one side and its descendants.
std::string without_forearm(const std::string& body, const std::string& side) {
  bool gone = false;
  return with_lines(body, [&](const std::string& line) {
    const std::size_t depth = line.find_first_not_of(' ');
    if (depth == std::string::npos) return line + "\n";
    const std::size_t depth_of_forearm = std::string("            ").size();
    gone = line.find(side + "ForeArm") != std::string::npos || (gone && depth > depth_of_forearm);
    return gone ? std::string() : line + "\n";
  });
}

void expect_no_arm(const std::string& body, const std::string& missing, const std::string& side) {
  const Skeleton skeleton = tiny_skeleton(body);
  for (const auto& profiles : {shipped_profiles(), std::vector<SkeletonProfile>()}) {
    SCOPED_TRACE(profiles.size());
    const auto refused = recognise_skeleton(skeleton, profiles);
    ASSERT_FALSE(refused) << "LeftArm is " << joint_name(*refused, skeleton, "LeftArm");
    EXPECT_EQ(refused.error().message, "no " + missing + " found in the skeleton");
    EXPECT_THAT(refused.error().hint, HasSubstr(OPTION("partial")));
    const auto map = value_of(recognise_skeleton(skeleton, profiles, {.partial = true}));
    for (const std::string part : {"Shoulder", "Arm"}) {
      EXPECT_EQ(joint_name(map, skeleton, (side + part).c_str()), side + part);
    }
    EXPECT_EQ(map.joint(bone_from_name(side + "ForeArm").value()), -1);
  }
}

TEST(LimbSearch, ClavicleAndUpperArmAreNotAnArm) {
  for (const char* body : {kBody, kLafan1}) {
    const std::string without_left = without_forearm(body, "Left");
    expect_no_arm(without_left, "left arm", "Left");
    expect_no_arm(without_forearm(body, "Right"), "right arm", "Right");
    expect_no_arm(without_forearm(without_left, "Right"), "arms", "Left");
  }
}

TEST(LimbSearch, ShapeDoesNotOverrideClearNames) {
  // Pads beyond the upper arms make chains of three joints.
  std::string body = without_forearm(without_forearm(kBody, "Left"), "Right");
  body = replaced(body, "LeftArm 12 0 0\n", "LeftArm 12 0 0\n            Pad 12 0 0\n");
  body = replaced(body, "RightArm -12 0 0\n", "RightArm -12 0 0\n            Pod -12 0 0\n");
  expect_no_arm(body, "arms", "Left");
}

TEST(LimbSearch, WordsMeanTheSameBoneOnBothSides) {
  // The left hand hangs from the upper arm.
  const std::string body = replaced(kBody, "            LeftForeArm 29 0 0\n", "");
  expect_no_arm(replaced(replaced(body, "              LeftHand 25", "            LeftHand 54"),
                         "                end 15", "              end 15"),
                "left arm", "Left");
}

TEST(LimbSearch, UnnamedForearmIsNotTheUpperArm) {
  const std::string body = replaced(replaced(kBody, "LeftForeArm", "Kq1"), "RightForeArm", "Zw7");
  const auto map = value_of(by_names(body));
  const Skeleton skeleton = tiny_skeleton(body);
  EXPECT_EQ(joint_name(map, skeleton, "LeftShoulder"), "LeftShoulder");
  EXPECT_EQ(joint_name(map, skeleton, "LeftArm"), "LeftArm");
  EXPECT_EQ(joint_name(map, skeleton, "LeftForeArm"), "Kq1");
  EXPECT_EQ(joint_name(map, skeleton, "RightForeArm"), "Zw7");
}

TEST(LimbSearch, ShoulderArmAndHandFormAnArm) {
  std::string body = replaced(replaced(kBody, "Shoulder", "Base"), "Arm ", "Shoulder ");
  body = replaced(body, "ForeShoulder", "Arm");
  const auto map = value_of(by_names(body));
  EXPECT_EQ(joint_name(map, tiny_skeleton(body), "LeftArm"), "LeftShoulder");
  EXPECT_EQ(joint_name(map, tiny_skeleton(body), "LeftForeArm"), "LeftArm");
}

}  // namespace
}  // namespace retarget
