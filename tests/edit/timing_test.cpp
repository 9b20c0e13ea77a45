#include <cmath>

#include "edit_sample.h"
#include "retarget/edit.h"
#include "retarget/resample.h"
#include "support/angles.h"
#include "support/clip_sampler.h"

namespace retarget {
namespace {

using namespace edit_test;

Result<Clip> change_speed(Clip clip, double speed) {
  return change_timing(std::move(clip), {.speed = speed});
}

// One joint that swings about z and along x.
Clip swinging(FrameRate rate, int frames, double hertz) {
  using enum Channel;
  Joint joint{"root",
              -1,
              Eigen::Vector3d::Zero(),
              {},
              {kXPosition, kYPosition, kZPosition, kZRotation, kYRotation, kXRotation}};
  Clip clip(std::make_shared<const Skeleton>(std::vector<Joint>{joint}), rate, frames);
  for (int i = 0; i < frames; ++i) {
    const double angle = 0.5 * std::sin(2.0 * kPi * hertz * rate.time_of(i));
    clip.translations(i)[0].x() = 2.0 * angle;
    clip.rotations(i)[0] = {std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle)};
  }
  return clip;
}

double turned(const Clip& clip, int frame) {
  const auto& q = clip.rotations(frame)[0];
  return 2.0 * std::atan2(q.z(), q.w());
}

// Positions and rotations of a 3 Hz swing with unit amplitude.
TEST(Timing, SineErrorFrom24To30IsBelow7PerMille) {
  const Clip fast = resample(swinging({24, 1}, 97, 3.0), {30, 1}).value();
  for (int i = 5; i + 5 < fast.frame_count(); ++i) {
    const double wanted = std::sin(2.0 * kPi * 3.0 * i / 30.0);
    EXPECT_NEAR(fast.translations(i)[0].x(), wanted, 0.007);
    EXPECT_NEAR(2.0 * turned(fast, i), wanted, 0.007);
  }
}

TEST(Timing, RemovesFrequenciesAbove20HzFrom120To30) {
  for (const double hertz : {20.0, 23.0, 40.0}) {
    const Clip slow = resample(swinging({120, 1}, 481, hertz), {30, 1}).value();
    for (int i = 10; i + 10 < slow.frame_count(); ++i) {
      EXPECT_LT(std::abs(slow.translations(i)[0].x()), 1e-3) << hertz;
      EXPECT_LT(std::abs(2.0 * turned(slow, i)), 2e-3) << hertz;
    }
  }
}

TEST(Timing, SpeedIsExactInTime) {
  // At 0.8 times the speed, a 2 Hz swing becomes a 1.6 Hz swing.
  const Clip slower = change_speed(swinging({30, 1}, 301, 2.0), 0.8).value();
  ASSERT_EQ(slower.frame_count(), 376);
  EXPECT_EQ(slower.rate(), (FrameRate{30, 1}));
  for (int i = 10; i + 10 < slower.frame_count(); ++i) {
    EXPECT_NEAR(slower.translations(i)[0].x(), std::sin(2.0 * kPi * 1.6 * i / 30.0), 3e-3);
  }
  EXPECT_FALSE(change_speed(slower, 0.0));
  EXPECT_FALSE(change_speed(slower, std::nan("")));
}

TEST(Timing, SpeedOneIsIdentity) {
  const Clip walk = recorded_clip("walk");
  EXPECT_EQ(largest_distance(change_speed(walk, 1.0).value(), walk, 0.01), 0.0);
}

// The size of a file does not determine the memory that a longer clip may need.
TEST(Timing, EditsThatLengthenAClipForgetTheSizeOfItsFile) {
  Clip walk = data_sample("walk").clip;
  ClipOrigin origin = walk.origin();
  origin.bytes = 1000;
  walk.set_origin(origin);
  const EditSample sample(walk);
  LoopOptions loop;
  loop.shortest = 0.9;
  loop.times = 3;
  EXPECT_EQ(make_loop(cut(walk, 100, 200), sample.calibration, loop).value().clip.origin().bytes,
            0U);
  EXPECT_EQ(concatenate(cut(walk, 0, 150), cut(walk, 150, 300), sample.calibration, {}, "a", "b")
                .value()
                .clip.origin()
                .bytes,
            0U);
  EXPECT_EQ(change_speed(walk, 0.5).value().origin().bytes, 0U);
  EXPECT_EQ(change_speed(walk, 0.5).value().name(), walk.name());
}

TEST(Timing, CanSampleAnyTime) {
  const Clip swing = swinging({30, 1}, 61, 1.0);
  const ClipSampler sampler(swing);
  std::vector<Eigen::Quaterniond> rotations(1);
  std::vector<Eigen::Vector3d> translations(1);
  sampler.sample(0.512, rotations, translations);
  EXPECT_NEAR(translations[0].x(), std::sin(2.0 * kPi * 0.512), 1e-4);
  sampler.sample(99.0, rotations, translations);
  EXPECT_EQ(translations[0], swing.translations(60)[0]);
}

TEST(Timing, HandlesClipsOfOneOrNoFrame) {
  EXPECT_EQ(change_speed(swinging({30, 1}, 1, 1.0), 0.5).value().frame_count(), 1);
  EXPECT_EQ(change_speed(swinging({30, 1}, 0, 1.0), 0.5).value().frame_count(), 0);
}

}  // namespace
}  // namespace retarget
