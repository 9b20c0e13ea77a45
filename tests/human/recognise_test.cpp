#include "human/skeleton/recognise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "formats/bvh/read_bvh.h"
#include "human/expect_bones.h"
#include "human/tiny_skeleton.h"
#include "retarget/human.h"
#include "support/lafan1_map.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Recognise, HipsAreTheParentOfTheLegsBelowARoot) {
  std::string body = "\nRoot 0 0 0";
  std::istringstream lines(kBody);
  for (std::string line; std::getline(lines, line);) body += "  " + line + "\n";
  expect_bones(body, {{"Hips", "Hips"}, {"Spine", "Spine"}});
}

TEST(Recognise, UsesTheLowerOfTwoNecks) {
  const std::string body = R"(
Hips 0 90 0
  LeftUpLeg 10 -2 0
    LeftLeg 0 -42 0
      LeftFoot 0 -41 0
  RightUpLeg -10 -2 0
    RightLeg 0 -42 0
      RightFoot 0 -41 0
  Spine 0 8 0
    Spine1 0 12 0
      Neck 0 37 0
        Neck1 0 5 0
          Head 0 5 0
      LeftArm 17 31 0
        LeftForeArm 29 0 0
          LeftHand 25 0 0
      RightArm -17 31 0
        RightForeArm -29 0 0
          RightHand -25 0 0
)";
  expect_bones(body, {{"Neck", "Neck"}, {"Head", "Head"}, {"Spine2", "Spine1"}});
}

TEST(Recognise, IgnoresPrefixes) {
  for (const std::string prefix :
       {"mixamorig:", "mixamorig1:", "Character1_", "Take 001:", "Skeleton 001_", "Actor_Body_"}) {
    SCOPED_TRACE(prefix);
    std::string body;
    std::istringstream lines(kBody);
    for (std::string line; std::getline(lines, line);) {
      const std::size_t at = line.find_first_not_of(' ');
      if (at != std::string::npos && line.compare(at, 4, "end ") != 0) line.insert(at, prefix);
      body += line + "\n";
    }
    const Skeleton skeleton = tiny_skeleton(body);
    const auto map = value_of(recognise(skeleton));
    EXPECT_EQ(joint_name(map, skeleton, "LeftArm"), prefix + "LeftArm");
    EXPECT_NE(map.profile, "topology");
    EXPECT_EQ(map.profile == "mixamo", prefix.starts_with("mixamo"));
  }
}

TEST(Recognise, RecognisesManySideSpellings) {
  struct Spelling {
    const char *left_before, *left_after, *right_before, *right_after;
  };
  for (const Spelling& spelling : std::vector<Spelling>{{"L_", "", "R_", ""},
                                                        {"", "_l", "", "_r"},
                                                        {"", ".L", "", ".R"},
                                                        {"l", "", "r", ""},
                                                        {"Bip01 L ", "", "Bip01 R ", ""},
                                                        {"Left ", "", "Right ", ""},
                                                        {"left_", "", "right_", ""}}) {
    SCOPED_TRACE(std::string(spelling.left_before) + "*" + spelling.left_after);
    std::string body = kBody;
    std::string left_arm;
    for (const char* bone :
         {"UpLeg", "Leg", "Foot", "ToeBase", "Shoulder", "Arm", "ForeArm", "Hand"}) {
      const std::string left = std::string(spelling.left_before) + bone + spelling.left_after;
      const std::string right = std::string(spelling.right_before) + bone + spelling.right_after;
      body = replaced(body, std::string("Left") + bone + " ", left + " ");
      body = replaced(body, std::string("Right") + bone + " ", right + " ");
      if (std::string(bone) == "Arm") left_arm = left;
    }
    expect_bones(body, {{"LeftArm", left_arm.c_str()}, {"Hips", "Hips"}});
  }
}

TEST(Recognise, NumberedSegmentsHaveNoSide) {
  const std::string body = renamed({{"Hips", "Pelvis"},
                                    {"Spine2", "T8"},
                                    {"Spine1", "L3"},
                                    {"Spine ", "L5 "},
                                    {"LeftLeg", "LeftLowerLeg"},
                                    {"RightLeg", "RightLowerLeg"},
                                    {"UpLeg", "UpperLeg"},
                                    {"LeftArm", "LeftUpperArm"},
                                    {"RightArm", "RightUpperArm"},
                                    {"ToeBase", "Toe"}});
  expect_bones(body, {{"Hips", "Pelvis"}, {"Spine", "L5"}, {"Spine1", "L3"}, {"Spine2", "T8"}});
  EXPECT_EQ(recognise(tiny_skeleton(body))->profile, "xsens_mvn");
}

TEST(Recognise, UsesShapeIfNamesAreMeaningless) {
  const Skeleton body = tiny_skeleton(kBody);
  const auto map = value_of(recognise(with_names(body, meaningless_names(body))));
  EXPECT_EQ(map.profile, "topology");
  EXPECT_EQ(map.joint_of_bone, recognise(body)->joint_of_bone);
}

TEST(Recognise, ShapeOverridesMixedUpNames) {
  const Skeleton body = tiny_skeleton(kBody);
  const auto expected = recognise(body)->joint_of_bone;
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::string> names = body.names();
    std::ranges::shuffle(names, random);
    const auto map = value_of(recognise(with_names(body, names)));
    EXPECT_EQ(map.joint_of_bone, expected);
  }
}

TEST(Recognise, IsIndependentOfChildOrder) {
  const std::string body = R"(
Hips 0 90 0
  Spine 0 8 0
    Spine1 0 12 0
      Spine2 0 13 0
        RightShoulder -5 18 0
          RightArm -12 0 0
            RightForeArm -29 0 0
              RightHand -25 0 0
        LeftShoulder 5 18 0
          LeftArm 12 0 0
            LeftForeArm 29 0 0
              LeftHand 25 0 0
        Neck 0 24 0
          Head 0 11 0
            end 0 18 0
  RightUpLeg -10 -2 0
    RightLeg 0 -42 0.5
      RightFoot 0 -41 -0.5
        RightToeBase 0 -6 13
  LeftUpLeg 10 -2 0
    LeftLeg 0 -42 0.5
      LeftFoot 0 -41 -0.5
        LeftToeBase 0 -6 13
)";
  expect_bones(body, {{"LeftUpLeg", "LeftUpLeg"}, {"LeftArm", "LeftArm"}, {"Spine2", "Spine2"}});
  const Skeleton skeleton = tiny_skeleton(body);
  const auto map = value_of(recognise(with_names(skeleton, meaningless_names(skeleton))));
  EXPECT_EQ(joint_name(map, skeleton, "LeftUpLeg"), "LeftUpLeg");
  EXPECT_EQ(joint_name(map, skeleton, "RightArm"), "RightArm");
}

TEST(Recognise, IgnoresProps) {
  std::string body =
      replaced(kBody, "                end -15 0 0\n", R"(                Sword -5 0 10
                  SwordTip 0 0 95
)");
  body += "  Holster -15 0 0\n    Pistol 0 -20 0\n  Cape 0 20 -10\n    Cape1 0 -40 0\n";
  expect_bones(body, {{"LeftHand", "LeftHand"}, {"RightHand", "RightHand"}, {"Hips", "Hips"}});
  const Skeleton skeleton = tiny_skeleton(body);
  const auto map = value_of(recognise(with_names(skeleton, meaningless_names(skeleton))));
  EXPECT_EQ(map.joint_of_bone, recognise(skeleton)->joint_of_bone);
}

// A body with this number of spine joints, 42 long in all; the arms hang from the last one.
std::string body_with_spine(int count) {
  std::string body = kBody;
  const std::size_t from = body.find("  Spine "), to = body.find("        Neck");
  std::string spine;
  for (int i = 0; i < count; ++i) {
    spine += std::string(2 * (i + 1), ' ') + "Spine" + (i == 0 ? "" : std::to_string(i)) + " 0 " +
             std::to_string(33.0 / count) + " 0\n";
  }
  std::istringstream rest(body.substr(to));
  std::string upper;
  for (std::string line; std::getline(rest, line);) {
    upper +=
        (count >= 3 ? std::string(2 * (count - 3), ' ') + line : line.substr(2 * (3 - count))) +
        "\n";
  }
  return body.substr(0, from) + spine + upper;
}

TEST(Recognise, HandlesSpinesOfAnyLength) {
  struct Case {
    int count;
    const char *spine, *spine1, *torso;
  };
  for (const Case& c : std::vector<Case>{{1, "", "", "Spine"},
                                         {2, "Spine", "", "Spine1"},
                                         {3, "Spine", "Spine1", "Spine2"},
                                         {4, "Spine", "Spine1", "Spine3"},
                                         {7, "Spine", "Spine3", "Spine6"}}) {
    SCOPED_TRACE(c.count);
    expect_bones(body_with_spine(c.count),
                 {{"Spine", c.spine}, {"Spine1", c.spine1}, {"Spine2", c.torso}});
  }
  const auto long_spine = recognise(tiny_skeleton(body_with_spine(7)));
  EXPECT_THAT(long_spine->notes, Contains(HasSubstr("folded into Spine2: \"Spine1\", \"Spine2\", "
                                                    "\"Spine4\", \"Spine5\"")));
}

TEST(Recognise, TorsoIsBelowTheNeckIfArmsHangFromIt) {
  const std::string body = R"(
Bip01 Pelvis 0 90 0
  Bip01 Spine 0 8 0
    Bip01 Spine1 0 12 0
      Bip01 Neck 0 30 0
        Bip01 Head 0 11 0
        Bip01 L Clavicle 5 0 0
          Bip01 L UpperArm 12 0 0
            Bip01 L Forearm 29 0 0
              Bip01 L Hand 25 0 0
        Bip01 R Clavicle -5 0 0
          Bip01 R UpperArm -12 0 0
            Bip01 R Forearm -29 0 0
              Bip01 R Hand -25 0 0
  Bip01 L Thigh 10 -2 0
    Bip01 L Calf 0 -42 0.5
      Bip01 L Foot 0 -41 -0.5
        Bip01 L Toe0 0 -6 13
  Bip01 R Thigh -10 -2 0
    Bip01 R Calf 0 -42 0.5
      Bip01 R Foot 0 -41 -0.5
        Bip01 R Toe0 0 -6 13
)";
  expect_bones(body, {{"Spine2", "Bip01 Spine1"},
                      {"Spine", "Bip01 Spine"},
                      {"Neck", "Bip01 Neck"},
                      {"LeftShoulder", "Bip01 L Clavicle"},
                      {"LeftUpLeg", "Bip01 L Thigh"}});
}

TEST(Recognise, HipsAreTheParentOfTheLegsEvenInTheSpine) {
  const Skeleton skeleton = tiny_skeleton(R"(
Bip01 0 90 0
  Bip01 Pelvis 0 0 0
    Bip01 Spine 0 2 0
      Bip01 Spine1 0 12 0
        Bip01 Neck 0 30 0
          Bip01 Head 0 11 0
          Bip01 L Clavicle 5 0 0
            Bip01 L UpperArm 12 0 0
              Bip01 L Forearm 29 0 0
          Bip01 R Clavicle -5 0 0
            Bip01 R UpperArm -12 0 0
              Bip01 R Forearm -29 0 0
      Bip01 L Thigh 10 -2 0
        Bip01 L Calf 0 -42 0.5
          Bip01 L Foot 0 -41 -0.5
      Bip01 R Thigh -10 -2 0
        Bip01 R Calf 0 -42 0.5
          Bip01 R Foot 0 -41 -0.5
)");
  const auto map = value_of(recognise(skeleton));
  EXPECT_EQ(joint_name(map, skeleton, "Hips"), "Bip01 Spine");
  EXPECT_EQ(joint_name(map, skeleton, "Spine2"), "Bip01 Spine1");
}

TEST(Recognise, WarnsAboutBackwardToes) {
  const auto clip_of = [](const std::string& body) {
    return Clip(std::make_shared<const Skeleton>(tiny_skeleton(body)), FrameRate{30, 1}, 2);
  };
  const auto sane = recognise_skeleton(clip_of(kBody), shipped_profiles());
  const auto odd = recognise_skeleton(
      clip_of(renamed({{"Left", "Middle"}, {"Right", "Left"}, {"Middle", "Right"}})),
      shipped_profiles());
  ASSERT_TRUE(sane && odd);
  EXPECT_THAT(sane->notes, Not(Contains(HasSubstr("swapped"))));
  EXPECT_THAT(odd->notes, Contains(HasSubstr("left and right may be swapped")));
  EXPECT_LT(odd->confidence, sane->confidence);
}

TEST(Recognise, IncludedSamplesAreLafan1) {
  for (const char* name : {"walk", "squat", "wave", "get_up", "turn_in_place"}) {
    SCOPED_TRACE(name);
    const auto path = std::filesystem::path(RETARGET_SOURCE_DIR) / "data" / name;
    const Clip clip = load_bvh(path.string() + ".bvh").value().clip;
    const auto map = value_of(recognise_skeleton(clip, shipped_profiles()));
    EXPECT_EQ(map.profile, "lafan1");
    EXPECT_EQ(map.notes, std::vector<std::string>());
    // The motion determines the sides if neither names nor zero pose do.
    const auto by_shape = value_of(recognise_skeleton(without_names(clip), shipped_profiles()));
    EXPECT_EQ(by_shape.joint_of_bone, map.joint_of_bone);
  }
}

TEST(Recognise, NotesMissingToesCollarsNeckAndHands) {
  const Skeleton skeleton = tiny_skeleton(R"(
Hips 0 90 0
  LeftUpLeg 10 -2 0
    LeftLeg 0 -42 0
      LeftFoot 0 -41 0
  RightUpLeg -10 -2 0
    RightLeg 0 -42 0
      RightFoot 0 -41 0
  Spine 0 20 0
    Head 0 35 0
    LeftArm 17 18 0
      LeftForeArm 29 0 0
    RightArm -17 18 0
      RightForeArm -29 0 0
)");
  const auto map = value_of(recognise(skeleton));
  EXPECT_FALSE(map.partial);
  EXPECT_THAT(map.notes, Contains("not in the source: LeftToe, RightToe, Spine, Spine1, Neck, "
                                  "LeftShoulder, LeftHand, RightShoulder, RightHand"));
}

TEST(Recognise, Lafan1MatchesThePublishedMethod) {
  const std::string further = replaced(
      std::string("Reference 0 0 0\n  Prop 5 5 5\n") +
          replaced(replaced(std::string(kLafan1).substr(1), "\n", "\n  "), "Hips", "  Hips"),
      "        LeftHand", "        Sleeve 0 3 0\n                LeftHand");
  for (const std::string& body :
       {std::string(kLafan1), replaced(kLafan1, "Toe", "ToeBase"), further}) {
    const Skeleton skeleton = tiny_skeleton(body);
    const auto map = value_of(recognise(skeleton));
    EXPECT_EQ(map.profile, "lafan1");
    const Calibration published = lafan1_calibration(skeleton);
    for (const Bone bone : kMappedBones) {
      EXPECT_EQ(map.joint_of_bone[bone], published.bones[bone].position_joint) << bone_name(bone);
    }
  }
}

TEST(Recognise, Lafan1NamesWithOtherAxesHaveAnotherProfile) {
  EXPECT_NE(recognise(tiny_skeleton(kBody))->profile, "lafan1");
  EXPECT_NE(recognise(tiny_skeleton(replaced(kBody, "ToeBase", "Toe")))->profile, "lafan1");
}

// Skeletons with HumanIK's names call the toes LeftToeBase or, as LAFAN1, LeftToe.
TEST(Recognise, ProfilesWithHumanIkNamesKnowBothNamesOfToes) {
  const auto map = value_of(recognise(tiny_skeleton(replaced(kBody, "ToeBase", "Toe"))));
  EXPECT_EQ(map.profile, "human_ik");
  for (const Bone bone : {Bone::kLeftToe, Bone::kRightToe}) {
    EXPECT_GE(map.joint_of_bone[bone], 0) << bone_name(bone);
  }
  for (const SkeletonProfile& profile : shipped_profiles()) {
    const auto& required = profile.required;
    const auto& names = profile.names[Bone::kLeftToe];
    if (std::ranges::count(names, "LeftToeBase") == 0 ||
        std::ranges::count(required, "LeftToeBase") > 0 || profile.name == "mixamo") {
      continue;
    }
    EXPECT_EQ(std::ranges::count(names, "LeftToe"), 1) << profile.name;
  }
}

}  // namespace
}  // namespace retarget
