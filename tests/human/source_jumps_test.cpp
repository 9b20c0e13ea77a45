#include "human/gait/source_jumps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <utility>

#include "retarget/human_poser.h"
#include "retarget/so3.h"
#include "support/lafan1_map.h"
#include "support/recorded_clip.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

SourceJumps jumps_of(const Clip& clip, bool thighs = true) {
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  HumanPoser poser(clip, calibration);
  return find_source_jumps(poser, {0, clip.frame_count()}, thighs);
}

TEST(SourceJumps, SamplesHaveNone) {
  for (const char* name : {"walk", "turn_in_place", "squat", "wave", "get_up"}) {
    EXPECT_EQ(jumps_of(recorded_clip(name)).frames, 0) << name;
  }
}

// A whole turn in 0.4 s, as in a fast spin.
TEST(SourceJumps, SpinsAreNone) {
  Clip clip = recorded_clip("wave");
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    auto& hips = clip.rotations(frame)[0];
    hips = exp_so3(Vector3d(0.0, 2.0 * std::numbers::pi * frame / 12.0, 0.0)) * hips;
  }
  EXPECT_EQ(jumps_of(clip).frames, 0);
}

// Estimates from video smear a flip over a few frames.
TEST(SourceJumps, FastTurnsOfSeveralFramesAreNone) {
  Clip clip = recorded_clip("wave");
  double angle = 0.0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    if (frame >= 50 && frame < 55) angle += 0.9;  // 27 rad/s
    auto& hips = clip.rotations(frame)[0];
    hips = exp_so3(Vector3d(0.0, angle, 0.0)) * hips;
  }
  EXPECT_EQ(jumps_of(clip).frames, 0);
  // Nor does the end of the turn look isolated in an excerpt that begins within it.
  const Calibration calibration = lafan1_calibration(clip.skeleton());
  HumanPoser poser(clip, calibration);
  for (int begin = 48; begin < 58; ++begin) {
    EXPECT_EQ(find_source_jumps(poser, {begin, begin + 30}, true).frames, 0) << begin;
  }
}

TEST(SourceJumps, NamesTeleportsAndReversals) {
  Clip moved = recorded_clip("walk"), turned = moved;
  for (int frame = 100; frame < moved.frame_count(); ++frame)
    moved.translations(frame)[0].x() += 80;
  const SourceJumps teleport = jumps_of(moved);
  EXPECT_EQ(teleport.frames, 1);
  EXPECT_EQ(teleport.first, 100);
  EXPECT_THAT(teleport.texts(), ElementsAre(HasSubstr("hips move at 2")));
  for (int frame = 100; frame < 110; ++frame) {
    auto& hips = turned.rotations(frame)[0];
    hips = exp_so3(Vector3d(0.0, std::numbers::pi, 0.0)) * hips;
  }
  const SourceJumps reversal = jumps_of(turned);
  EXPECT_EQ(reversal.frames, 2);
  EXPECT_EQ(reversal.first, 100);
  EXPECT_THAT(reversal.texts(), ElementsAre(HasSubstr("hips turn at 9")));
}

// Hips whose rotation was computed from noisy positions turn without the chest.
TEST(SourceJumps, OfPositionsAreThoseOfTheWholeBody) {
  Clip clip = recorded_clip("walk");
  const auto spine = static_cast<std::size_t>(clip.skeleton().find("Spine").value());
  const auto turn = exp_so3(Vector3d(0.0, 1.0, 0.0));
  for (int frame = 100; frame < clip.frame_count(); ++frame) {
    clip.rotations(frame)[0] = clip.rotations(frame)[0] * turn;
    clip.rotations(frame)[spine] = turn.conjugate() * clip.rotations(frame)[spine];
  }
  EXPECT_EQ(jumps_of(clip, true).frames, 1);
  EXPECT_EQ(jumps_of(clip, false).frames, 0);
}

TEST(SourceJumps, NamesTurnedThighsWithKnownRotations) {
  Clip clip = recorded_clip("walk");
  const auto thigh = static_cast<std::size_t>(clip.skeleton().find("LeftUpLeg").value());
  for (int frame = 100; frame < 110; ++frame) {
    auto& rotation = std::as_const(clip).rotations(frame)[thigh];
    clip.rotations(frame)[thigh] = rotation * exp_so3(Vector3d(std::numbers::pi, 0.0, 0.0));
  }
  EXPECT_EQ(jumps_of(clip).frames, 2);
  EXPECT_THAT(jumps_of(clip).texts(), ElementsAre(HasSubstr("thighs turn at 9")));
  EXPECT_EQ(jumps_of(clip, false).frames, 0);
}

}  // namespace
}  // namespace retarget
