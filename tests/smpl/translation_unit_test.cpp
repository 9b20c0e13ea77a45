
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "formats/smpl/read_smpl.h"
#include "motion_parts.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

// A body whose pelvis moves forward by `stride` metres per frame over a planted left foot while the
// right one swings (with `glides` both move along); trans in another unit.
std::string moving_npz(double unit, double stride, double height, bool glides) {
  constexpr std::size_t kMovingFrames = 9;
  constexpr double kLeg = 0.81;  // Leg length of the generic body.
  std::vector<double> poses(66 * kMovingFrames), trans(3 * kMovingFrames);
  for (std::size_t frame = 0; frame < kMovingFrames; ++frame) {
    const double way = stride * static_cast<double>(frame);
    poses[66 * frame] = M_PI / 2;  // z up, facing -y
    if (!glides) {
      poses[66 * frame + 3] = std::asin(way / kLeg);
      poses[66 * frame + 6] = -std::asin(way / kLeg);
    }
    trans[3 * frame + 1] = -unit * way;
    trans[3 * frame + 2] = unit * height;
  }
  NpzBuilder builder;
  builder.add("poses", npy_doubles({kMovingFrames, 66}, poses));
  builder.add("trans", npy_doubles({kMovingFrames, 3}, trans));
  builder.add("fps", npy_doubles({}, {30}));
  return builder.build();
}

// Metres per unit of the clip.
double metres_of(double unit, double stride, double height, bool glides = false) {
  const SmplMotion motion = motion_of(moving_npz(unit, stride, height, glides));
  const double metres = motion.clip.translation(0, 0).z() / (unit * height);
  EXPECT_EQ(warnings_of(motion).find("assuming that trans") == std::string::npos, metres == 1.0);
  return metres;
}

TEST(TranslationUnitTest, IsFoundByTheHeightOfStandingBodies) {
  EXPECT_DOUBLE_EQ(metres_of(1.0, 0.0, 0.9), 1.0);
  EXPECT_DOUBLE_EQ(metres_of(100.0, 0.0, 0.9), 0.01);
  EXPECT_DOUBLE_EQ(metres_of(1000.0, 0.0, 0.9), 0.001);
}

TEST(TranslationUnitTest, IsFoundByTheSpeedOfWalkingBodies) {
  for (const double height : {0.9, 0.02}) {
    EXPECT_DOUBLE_EQ(metres_of(1.0, 0.04, height), 1.0);
    EXPECT_DOUBLE_EQ(metres_of(100.0, 0.04, height), 0.01);
    EXPECT_DOUBLE_EQ(metres_of(1000.0, 0.04, height), 0.001);
  }
}

TEST(TranslationUnitTest, SkatersCarsAndHillsAreInMetres) {
  EXPECT_DOUBLE_EQ(metres_of(1.0, 0.5, 0.9, true), 1.0);
  EXPECT_DOUBLE_EQ(metres_of(1.0, 0.0, 300.0), 1.0);
  EXPECT_DOUBLE_EQ(metres_of(1.0, 0.04, 90.0), 1.0);
}

TEST(TranslationUnitTest, MessageStatesTheReason) {
  EXPECT_THAT(
      warnings_of(motion_of(moving_npz(100.0, 0.04, 0.9, false))),
      HasSubstr("assuming that trans is in centimetres: in metres the slower foot would have 1"));
  EXPECT_THAT(warnings_of(motion_of(moving_npz(100.0, 0.0, 0.9, false))),
              HasSubstr("in metres the feet would be at a height of 89 m"));
}

}  // namespace
}  // namespace retarget
