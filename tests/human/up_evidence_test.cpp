#include "human/skeleton/up_evidence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "formats/bvh/read_bvh.h"
#include "human/hand_made_maps.h"
#include "human/postures.h"
#include "human/twins.h"
#include "retarget/resample.h"
#include "support/recorded_clip.h"
#include "support/shared_data.h"

namespace retarget {
namespace {

std::optional<SignedAxis> fall_of(const Clip& clip) {
  return free_fall_axis(clip, Body(clip.skeleton(), lafan1_map(clip.skeleton(), "test")), 0);
}

// A hopping body: parabolas of half a second, with the feet on the floor for as long in between.
Clip hopping() {
  Clip clip = PostureClips(recorded_clip("walk")).make(Posture::kStanding, 0.0, 90);
  constexpr double kFlight = 0.5, kGravity = 981.0;  // s, cm/s^2
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double phase = std::fmod(frame / 30.0, 2.0 * kFlight);
    if (phase < kFlight)
      clip.translations(frame)[0].y() += 0.5 * kGravity * phase * (kFlight - phase);
  }
  return clip;
}

TEST(FreeFall, DeterminesTheUpAxisOfAHoppingBody) {
  const Clip clip = hopping();
  EXPECT_EQ(fall_of(clip), SignedAxis{});
  for (const SignedAxis up : {SignedAxis{0, false}, SignedAxis{2, false}, SignedAxis{2, true}}) {
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), up.direction());
    EXPECT_EQ(fall_of(scaled_and_turned(clip, 0.01, turn)), up) << to_text(up);
  }
}

// Between steps of a run, the body rebounds for less than a fifth of a second with an acceleration
// like that of gravity, but upwards. Five samples at 24 Hz are shorter than that.
TEST(FreeFall, IsNotTheReboundOfARunner) {
  if (!shared_folder()) GTEST_SKIP() << kNoSharedFolder;
  const std::string file = "data/lafan1_cuts/run2_subject4_run.bvh";
  const Clip run = load_bvh((*shared_folder() / file).string()).value().clip;
  for (const double fps : {20.0, 23.976, 24.0, 25.0, 30.0}) {
    for (int begin = 0; begin + 300 <= run.frame_count(); begin += 130) {
      const Clip part =
          resample(cut(run, begin, begin + 300), frame_rate_from_fps(fps), {.antialias = false})
              .value();
      const auto up = fall_of(part);
      EXPECT_TRUE(!up || *up == SignedAxis{}) << fps << " fps, frame " << begin;
    }
  }
}

// The hips move a little beyond the noise of a centred root.
TEST(FloorEvidence, PlacesHipsAtAnyHeading) {
  Clip clip = PostureClips(recorded_clip("walk")).make(Posture::kStanding, 0.0, 60);
  const Body body(clip.skeleton(), lafan1_map(clip.skeleton(), "test"));
  const double leg = leg_length(body);
  for (const double range : {0.15, 0.25}) {
    for (const double heading : {0.0, 0.4, 0.8, 1.2}) {
      std::vector<JointPoses> poses;
      for (int frame = 0; frame < clip.frame_count(); ++frame) {
        const double along = range * leg * (frame / 59.0 - 0.5);
        clip.translations(frame)[0] = {along * std::cos(heading), 0.001 * leg * std::sin(frame),
                                       along * std::sin(heading)};
        poses.push_back(frame_pose(clip, frame));
      }
      EXPECT_EQ(floor_evidence(body, poses, SignedAxis{}).is_placed, range > 0.2) << heading;
    }
  }
}

TEST(FreeFall, IsNotDetectedInSupportedBodies) {
  for (const char* name : {"walk", "squat", "get_up", "wave", "turn_in_place"}) {
    EXPECT_EQ(fall_of(recorded_clip(name)), std::nullopt) << name;
  }
  const PostureClips postures(recorded_clip("walk"));
  for (const Posture posture : kPostures) {
    EXPECT_EQ(fall_of(postures.make(posture, 30.0)), std::nullopt) << posture_name(posture);
  }
}

// Smoothing rounds landings, so that the centre of mass follows parabolas that open upwards. Unlike
// falls, they differ: the feet push the body forwards and backwards.
TEST(FreeFall, IsNotSmoothedLandings) {
  Clip clip = PostureClips(recorded_clip("walk")).make(Posture::kStanding, 0.0, 240);
  constexpr double kRate = 1.5, kAngular = 2.0 * M_PI * kRate;  // Landings per second, rad/s.
  constexpr double kAcceleration = 1200.0, kSharp = 0.15;       // At a landing, cm/s^2.
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const double angle = kAngular * frame / 30.0;
    const double height = -kAcceleration / (kAngular * kAngular * (1.0 + 4.0 * kSharp)) *
                          (std::cos(angle) + kSharp * std::cos(2.0 * angle));
    const double push = 0.4 * (std::fmod(std::floor(kRate * frame / 30.0 + 0.5), 3.0) - 1.0);
    clip.translations(frame)[0] += Eigen::Vector3d(push * height, height, 0.0);
  }
  EXPECT_EQ(fall_of(clip), std::nullopt);
}

}  // namespace
}  // namespace retarget
