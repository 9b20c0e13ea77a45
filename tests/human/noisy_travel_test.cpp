// Noise of the legs does not change the travel of a clip.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "formats/smpl/joint_motion.h"
#include "human/gait/clean_clip.h"
#include "human/gait/drift_travel.h"
#include "human/skeleton/joint_clip.h"
#include "retarget/so3.h"
#include "support/lafan1_map.h"
#include "support/normal_numbers.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// The clip as a file of joint positions with independent errors, RMS in the clip's unit per axis.
Clip keypoints_of(const Clip& clip, double error, std::uint32_t seed) {
  JointMotion motion;
  motion.frame_count = clip.frame_count();
  motion.joint_count = clip.skeleton().joint_count();
  motion.names = clip.skeleton().names();
  motion.rate = clip.rate();
  NormalNumbers normal(seed);
  std::vector<Pose> world(static_cast<std::size_t>(motion.joint_count));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    forward_kinematics(clip, frame, world);
    for (const Pose& pose : world) {
      motion.positions.push_back(pose.translation + error * normal.next_vector());
    }
  }
  return clip_of_joints(motion, "walk.npy").value();
}

// Rotations with errors of this RMS angle about each axis, degrees, and a correlation time of 0.3 s.
Clip with_slow_noise(Clip clip, double degrees, std::uint32_t seed) {
  NormalNumbers normal(seed);
  const double keep = std::exp(-clip.rate().frame_time() / 0.3);
  const double fresh = std::sqrt(1.0 - keep * keep) * degrees * std::numbers::pi / 180.0;
  std::vector<Vector3d> errors(static_cast<std::size_t>(clip.skeleton().joint_count()),
                               Vector3d::Zero());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    for (std::size_t joint = 0; joint < errors.size(); ++joint) {
      errors[joint] = keep * errors[joint] + fresh * normal.next_vector();
      clip.rotations(frame)[joint] = clip.rotations(frame)[joint] * exp_so3(errors[joint]);
    }
  }
  return clip;
}

double farthest_path(const Clip& a, const Clip& b) {
  double farthest = 0.0;
  for (int frame = 0; frame < a.frame_count(); ++frame) {
    const Vector3d off = a.translations(frame)[0] - b.translations(frame)[0];
    farthest = std::max(farthest, std::hypot(off.x(), off.z()));
  }
  return farthest;
}

TEST(NoisyTravel, NoisyPositionsDoNotMoveTheRoot) {
  const Clip walk = recorded_clip("walk");
  const Clip clean = keypoints_of(walk, 0.0, 0);
  const Calibration calibration = lafan1_calibration(clean.skeleton());
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    Clip noisy = keypoints_of(walk, 2.0, seed);
    const PositionJitter smoothed = clean_positions(noisy);
    ASSERT_NE(smoothed.note, "");
    (void)clean_clip(noisy, {0, noisy.frame_count()}, calibration, smoothed.foot_noise);
    EXPECT_LT(farthest_path(noisy, clean), 6.0) << seed;  // Centimetres.
  }
}

TEST(NoisyTravel, SwayUnderNoisyLegsIsFound) {
  const Clip squat = recorded_clip("squat");
  Clip noisy = with_slow_noise(squat, 3.0, 1);
  for (int frame = 0; frame < noisy.frame_count(); ++frame) {
    const double seconds = frame * noisy.rate().frame_time();
    noisy.translations(frame)[0].x() += 20.0 * std::sin(0.5 * std::numbers::pi * seconds);
  }
  const Calibration calibration = lafan1_calibration(noisy.skeleton());
  const CleanReport report = clean_clip(noisy, {0, noisy.frame_count()}, calibration);
  EXPECT_GT(report.root_moved, 0.15);
  EXPECT_LT(farthest_path(noisy, squat), 15.0);
}

std::vector<Vector3d> steady_drift(double speed, int frames = 300) {
  std::vector<Vector3d> drift;
  for (int frame = 0; frame < frames; ++frame) {
    const double seconds = frame / 30.0;
    drift.emplace_back(speed * seconds, 0.02 * std::sin(8.0 * std::numbers::pi * seconds), seconds);
  }
  return drift;
}

TEST(NoisyTravel, ASlowDriftIsKeptOnlyIfTheLegsDoNotExplainIt) {
  for (const double speed : {0.1, 0.3}) {
    const std::vector<Vector3d> whole = steady_drift(speed);
    std::vector<Vector3d> drift = whole;
    keep_travel(drift, 0.1, 1.0 / 30.0);
    const bool is_explained = speed < 0.18;
    for (std::size_t i = 30; i < 270; ++i) {
      EXPECT_NEAR(drift[i].x(), is_explained ? 0.0 : whole[i].x(), 1e-3);
      // Fast changes and heights remain.
      EXPECT_NEAR(drift[i].y(), whole[i].y(), 1e-3);
      EXPECT_EQ(drift[i].z(), whole[i].z());
    }
  }
}

// Errors of the legs accumulate for less time in a clip of less than a second.
TEST(NoisyTravel, AShortDriftIsJudgedByItsOwnTime) {
  for (const int frames : {8, 15, 30}) {
    const std::vector<Vector3d> fast = steady_drift(0.6, frames);
    std::vector<Vector3d> drift = fast;
    keep_travel(drift, 0.1, 1.0 / 30.0);
    EXPECT_EQ(drift, fast) << frames;
    drift = steady_drift(0.1, frames);
    keep_travel(drift, 0.1, 1.0 / 30.0);
    EXPECT_LT(drift.back().x() - drift.front().x(), 0.5 * 0.1 * (frames - 1) / 30.0) << frames;
  }
  std::vector<Vector3d> single = {Vector3d::Ones()};
  keep_travel(single, 0.1, 1.0 / 30.0);
  EXPECT_EQ(single.front(), Vector3d::Ones());
}

}  // namespace
}  // namespace retarget
