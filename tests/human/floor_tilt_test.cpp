#include "human/gait/floor_tilt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "retarget/so3.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;

std::optional<FloorTilt> tilt_of(const Clip& clip, const Vector3d& turn) {
  Calibration calibration = lafan1_calibration(clip.skeleton());
  calibration.human_from_source = exp_so3(turn).toRotationMatrix() * calibration.human_from_source;
  HumanPoser poser(clip, calibration);
  return find_floor_tilt(poser, {0, clip.frame_count()});
}

TEST(FloorTilt, MeasuresTheTiltOfAWalk) {
  const Clip walk = recorded_clip("walk");
  for (const Vector3d& axis :
       {Vector3d(1.0, 0.0, 0.0), Vector3d(0.0, 1.0, 0.0), Vector3d(-0.6, 0.8, 0.0)}) {
    for (const double degrees : {10.0, 20.0, 30.0}) {
      const Vector3d turn = degrees * kDegree * axis;
      const auto found = tilt_of(walk, turn);
      ASSERT_TRUE(found) << degrees;
      EXPECT_FALSE(found->by_balance);
      EXPECT_NEAR(found->angle, degrees * kDegree, kDegree);
      EXPECT_LT(angle_between(found->up, exp_so3(turn) * Vector3d::UnitZ()), 1.5 * kDegree);
    }
  }
}

TEST(FloorTilt, MeasuresKeypointsWithNoiseAndWithoutToes) {
  Clip walk = recorded_clip("walk");
  for (int frame = 0; frame < walk.frame_count(); ++frame) {
    // Centimetres; the sum of sines moves by about 0.2 m/s.
    walk.translations(frame)[0] +=
        0.7 * Vector3d(std::sin(2.1 * frame), 0.0, std::sin(1.7 * frame));
  }
  const Vector3d turn(0.0, 12.0 * kDegree, 0.0);
  Calibration calibration = lafan1_calibration(walk.skeleton());
  calibration.human_from_source = exp_so3(turn).toRotationMatrix() * calibration.human_from_source;
  calibration.bones[Bone::kLeftToe] = calibration.bones[Bone::kRightToe] = {};
  HumanPoser poser(walk, calibration);
  const auto found = find_floor_tilt(poser, {0, walk.frame_count()});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->angle, 12.0 * kDegree, 1.5 * kDegree);
}

TEST(FloorTilt, LevelWorldsHaveNone) {
  for (const char* name : {"walk", "squat", "get_up", "turn_in_place", "wave"}) {
    EXPECT_FALSE(tilt_of(recorded_clip(name), Vector3d::Zero())) << name;
  }
  EXPECT_FALSE(tilt_of(recorded_clip("walk"), Vector3d(5.0 * kDegree, 0.0, 0.0)));
}

TEST(FloorTilt, UprightBodiesOnSlopesHaveNone) {
  constexpr double kSlope = 0.25;  // 14 degrees.
  Clip walk = recorded_clip("walk");
  for (int frame = 0; frame < walk.frame_count(); ++frame) {
    Vector3d& root = walk.translations(frame)[0];
    root.y() += kSlope * (root.x() + root.z());  // Y is up in the file.
  }
  EXPECT_FALSE(tilt_of(walk, Vector3d::Zero()));
  // The toes do fit a plane.
  EXPECT_TRUE(tilt_of(walk, Vector3d(0.0, 30.0 * kDegree, 0.0)) ||
              tilt_of(walk, Vector3d(30.0 * kDegree, 0.0, 0.0)));
}

// The feet show no plane, but the body would fall.
TEST(FloorTilt, OfABodyThatStandsOnOneSpotFollowsFromItsBalance) {
  for (const char* name : {"wave", "squat"}) {
    for (const Vector3d& turn :
         {Vector3d(20.0 * kDegree, 0.0, 0.0), Vector3d(0.0, 20.0 * kDegree, 0.0),
          Vector3d(-12.0 * kDegree, 16.0 * kDegree, 0.0)}) {
      const auto found = tilt_of(recorded_clip(name), turn);
      ASSERT_TRUE(found) << name;
      EXPECT_TRUE(found->by_balance) << name;
      EXPECT_LT(angle_between(found->up, exp_so3(turn) * Vector3d::UnitZ()), 5.0 * kDegree) << name;
    }
  }
}

TEST(FloorTilt, ShortClipsGiveNoEvidence) {
  const Clip walk = recorded_clip("walk");
  Calibration calibration = lafan1_calibration(walk.skeleton());
  HumanPoser poser(walk, calibration);
  EXPECT_FALSE(find_floor_tilt(poser, {0, 0}));
  EXPECT_FALSE(find_floor_tilt(poser, {0, 1}));
}

}  // namespace
}  // namespace retarget
