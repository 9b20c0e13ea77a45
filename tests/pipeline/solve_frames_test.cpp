#include "solve/targets/solve_frames.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "formats/bvh/read_bvh.h"
#include "support/lafan1_map.h"
#include "support/test_robots.h"
#include "support/value_of.h"

namespace retarget {
namespace {

ResolvedConfig one_bone_config() {
  ResolvedConfig config;
  config.human_height_assumption = 1.0;
  return config;
}

// The root of frame n is at x = n.
void stand_at_frame(int frame, HumanPose& world_from_bone) {
  world_from_bone[Bone::kHips].translation.x() = frame;
}

void expect_frames(TargetStream& stream, int count, std::chrono::microseconds pause) {
  for (int frame = 0; frame < count; ++frame) {
    if (frame % 97 == 0) std::this_thread::sleep_for(pause);
    const auto targets = stream.next();
    ASSERT_EQ(targets.size(), 1U);
    // A slot overwritten too early contains another frame.
    ASSERT_EQ(targets[0].translation.x(), frame);
  }
}

TEST(TargetStream, YieldsEveryFrameInOrder) {
  const TargetBuilder targets(one_bone_config(), 1.0);
  for (const bool ahead : {false, true}) {
    for (const int count : {0, 1, 31, 32, 33, 255, 256, 257, 5000}) {
      TargetStream stream(count, stand_at_frame, targets, ahead);
      expect_frames(stream, count, std::chrono::microseconds(0));
    }
  }
}

TEST(TargetStream, SynchronisesProducerAndConsumer) {
  const TargetBuilder targets(one_bone_config(), 1.0);
  const auto slow = [](int frame, HumanPose& world_from_bone) {
    if (frame % 50 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
    stand_at_frame(frame, world_from_bone);
  };
  TargetStream slow_source(2000, slow, targets, true);
  expect_frames(slow_source, 2000, std::chrono::microseconds(0));
  TargetStream slow_reader(2000, stand_at_frame, targets, true);
  expect_frames(slow_reader, 2000, std::chrono::microseconds(500));
}

TEST(TargetStream, RunAheadIsBounded) {
  const TargetBuilder targets(one_bone_config(), 1.0);
  std::atomic<int> latest = 0;
  const auto source = [&](int frame, HumanPose& world_from_bone) {
    latest = frame;
    stand_at_frame(frame, world_from_bone);
  };
  TargetStream stream(100'000, source, targets, true);
  (void)stream.next();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_LT(latest, 1000);
}

// An interrupted run does not read all frames.
TEST(TargetStream, CanBeAbandonedAnywhere) {
  const TargetBuilder targets(one_bone_config(), 1.0);
  for (const int read : {0, 1, 32, 33, 300}) {
    TargetStream stream(100'000, stand_at_frame, targets, true);
    expect_frames(stream, read, std::chrono::microseconds(0));
  }
}

// Whole clips: with and without the second thread, and from precomputed poses.
TEST(Retarget, TargetStreamDoesNotChangeTheResult) {
  const std::filesystem::path source(RETARGET_SOURCE_DIR);
  const auto clip = load_bvh((source / "data" / "walk.bvh").string()).value().clip;
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  const auto robot = load_g1();
  const auto config =
      load_config((source / "configs" / "lafan1_to_unitree_g1.json").string(), *robot).value();
  const auto& limits = robot->model_limits();
  SolveFramesOptions alone, ahead;
  ahead.targets_ahead = true;
  int solved = 0;
  ahead.frame_solved = [&](int frame, std::span<const double>) { EXPECT_EQ(frame, solved++); };
  const auto expected =
      value_of(solve_frames(to_human(clip, calibration), robot, config, limits, alone));
  for (const SolveFramesOptions& options : {alone, ahead}) {
    const auto result = value_of(solve_frames(clip, calibration, robot, config, limits, options));
    ASSERT_EQ(result.clip.frame_count(), clip.frame_count());
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      ASSERT_TRUE(std::ranges::equal(result.clip.qpos(frame), expected.clip.qpos(frame)));
    }
    EXPECT_EQ(result.mean_error, expected.mean_error);
  }
  EXPECT_EQ(solved, clip.frame_count());
}

}  // namespace
}  // namespace retarget
