#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/option_name.h"
#include "human/skeleton/recognise.h"
#include "human/tiny_skeleton.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

TEST(RecogniseRefuses, BodiesWithoutLegsOrArmsUnlessPartial) {
  const Skeleton upper = tiny_skeleton(R"(
Hips 0 90 0
  Spine 0 20 0
    Head 0 35 0
    LeftArm 17 18 0
      LeftForeArm 29 0 0
        LeftHand 25 0 0
    RightArm -17 18 0
      RightForeArm -29 0 0
        RightHand -25 0 0
)");
  const auto refused = recognise(upper);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kInput);
  EXPECT_EQ(refused.error().message, "no legs found in the skeleton");
  EXPECT_THAT(refused.error().hint, HasSubstr(OPTION("partial")));
  const auto map = value_of(recognise(upper, true));
  EXPECT_TRUE(map.partial);
  EXPECT_EQ(joint_name(map, upper, "Hips"), "Hips");
  EXPECT_EQ(joint_name(map, upper, "Spine2"), "Spine");
}

TEST(RecogniseRefuses, NonBodiesEvenIfPartial) {
  const Skeleton toy =
      tiny_skeleton("Hips 0 0 0\n  Spine 0 10 0\n    Head 0 8 0\n  LeftLeg 2 -8 0\n");
  for (const bool partial : {false, true}) {
    const auto map = recognise(toy, partial);
    ASSERT_FALSE(map);
    EXPECT_EQ(map.error().message, "not a human skeleton: no legs and arms found in its 4 joints");
  }
}

TEST(RecogniseRefuses, DuplicateNames) {
  const auto map = recognise(tiny_skeleton(replaced(kBody, "RightArm", "LeftArm")));
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().kind, ErrorKind::kInput);
  EXPECT_THAT(map.error().message, HasSubstr("2 joints are called \"LeftArm\""));
  // The name of a finger does not identify a body.
  EXPECT_TRUE(recognise(
      tiny_skeleton(replaced(kBody, "                end 15 0 0\n",
                             "                Finger 5 0 1\n                Finger 5 0 -1\n"))));
}

TEST(RecogniseRefuses, NonHumanBodiesWithHumanNames) {
  std::string dog = kBody;
  for (const char* length : {"-42 0.5", "-41 -0.5"}) dog = replaced(dog, length, "-17 0");
  dog += "  Tail 0 0 -10\n";
  const auto map = recognise(tiny_skeleton(dog));
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error().message, HasSubstr("the skeleton is not human: the legs are shorter"));
}

TEST(RecogniseRefuses, UndecidableSides) {
  // LAFAN1's zero pose is impossible for a human: without names it does not determine left and
  // right.
  const Skeleton skeleton = tiny_skeleton(kLafan1);
  const auto map = recognise(with_names(skeleton, meaningless_names(skeleton)));
  ASSERT_FALSE(map);
  EXPECT_THAT(map.error().message, HasSubstr("distinguish the left and the right side"));
}

TEST(RecogniseRefuses, VeryDeepTrees) {
  std::vector<Joint> joints(3000);
  for (int i = 0; i < 3000; ++i) {
    joints[i].name = "j" + std::to_string(i);
    joints[i].parent = i - 1;
    joints[i].offset = Eigen::Vector3d(0, 1, 0);
  }
  EXPECT_FALSE(recognise(Skeleton(std::move(joints))));
}

}  // namespace
}  // namespace retarget
