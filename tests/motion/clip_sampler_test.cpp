#include "support/clip_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "motion/test_clips.h"

namespace retarget {
namespace {

constexpr FrameRate k24{24, 1};

double wave(double t) {
  return std::sin(3.0 * t) + 0.3 * t;
}

// A clip and its sampler.
struct Sampled {
  Clip clip;
  ClipSampler sampler;

  explicit Sampled(Clip source, Interpolation interpolation = Interpolation::kCubic)
      : clip(std::move(source)), sampler(clip, interpolation) {
    make_sign_continuous(clip);
  }
};

// One sample as a clip of one frame.
Clip sample_at(const Sampled& sampled, double time) {
  const auto& [clip, sampler] = sampled;
  Clip pose(clip.shared_skeleton(), clip.rate(), 1);
  sampler.sample(time, pose.rotations(0), pose.translations(0));
  return pose;
}

TEST(ClipSampler, ReturnsFramesBitForBit) {
  for (const FrameRate rate : {k24, FrameRate{2997, 125}, FrameRate{120, 1}, FrameRate{1, 3}}) {
    const Clip clip = make_clip(rate, 100, wave);
    for (const auto interpolation : {Interpolation::kLinear, Interpolation::kCubic}) {
      const Sampled sampler(clip, interpolation);
      for (int frame = 0; frame < 100; ++frame) {
        EXPECT_TRUE(same_bits(sample_at(sampler, rate.time_of(frame)), 0, sampler.clip, frame));
      }
    }
  }
}

TEST(ClipSampler, FollowsASmoothMotionBetweenFrames) {
  const Sampled sampler(make_clip(k24, 49, wave));
  for (double time = 0.0; time <= 2.0; time += 0.003) {
    const Clip pose = sample_at(sampler, time);
    const auto at_time = [&](double) { return wave(time); };
    EXPECT_LE(translation_error(pose, at_time, 0, 1), 2e-5) << time;
    EXPECT_LE(rotation_error(pose, at_time, 0, 1), 2e-5) << time;
  }
}

TEST(ClipSampler, ClampsOutsideTheClip) {
  const Sampled sampler(make_clip(k24, 25, wave));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double time : {-1.0, -1e-12, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(same_bits(sample_at(sampler, time), 0, sampler.clip, 0)) << time;
  }
  for (const double time : {1.0, 1.0 + 1e-12, 50.0, kInfinity}) {
    EXPECT_TRUE(same_bits(sample_at(sampler, time), 0, sampler.clip, 24)) << time;
  }
}

TEST(ClipSampler, OneFrameIsConstantAndTwoAreLinear) {
  for (const auto interpolation : {Interpolation::kLinear, Interpolation::kCubic}) {
    const Sampled one(make_clip(k24, 1, wave), interpolation);
    EXPECT_TRUE(same_bits(sample_at(one, 0.5), one.clip));
    const Sampled two(make_clip(k24, 2, [](double t) { return 1.0 + t; }), interpolation);
    const Clip middle = sample_at(two, 0.25 / 24.0);
    const auto expected = [](double) { return 1.0 + 0.25 / 24.0; };
    EXPECT_LE(translation_error(middle, expected, 0, 1), 1e-15);
    EXPECT_LE(rotation_error(middle, expected, 0, 1), 1e-15);
  }
  EXPECT_EQ(ClipSampler(make_clip(k24, 0, wave)).frame_count(), 0);
}

TEST(ClipSampler, ResultIsSignContinuousInTime) {
  Clip clip = make_clip(k24, 49, [](double t) { return 9.0 * t; });
  for (int frame = 0; frame < 49; frame += 3) {
    for (auto& q : clip.rotations(frame)) q.coeffs() = -q.coeffs();
  }
  const Sampled sampler(clip);
  Clip before = sample_at(sampler, 0.0);
  for (double time = 0.0; time <= 2.0; time += 0.007) {
    const Clip now = sample_at(sampler, time);
    for (int joint = 0; joint < 5; ++joint) {
      EXPECT_GT(std::as_const(now).rotations(0)[joint].dot(before.rotations(0)[joint]), 0.9);
    }
    before = now;
  }
}

}  // namespace
}  // namespace retarget
