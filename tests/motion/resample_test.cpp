#include "retarget/resample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "motion/test_clips.h"
#include "support/angles.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

constexpr FrameRate kRate24{24, 1}, kRate30{30, 1}, k60{60, 1}, k120{120, 1};
constexpr ResampleOptions kLinearOptions{Interpolation::kLinear, true};
constexpr ResampleOptions kPlainOptions{Interpolation::kCubic, false};

AngleOverTime tone(double frequency, double amplitude = 1.0) {
  return [=](double t) { return amplitude * std::sin(2.0 * kPi * frequency * t); };
}

Clip resampled(const Clip& clip, const FrameRate& rate, const ResampleOptions& options = {}) {
  return value_of(resample(clip, rate, options));
}

TEST(Resample, SparseClipsDoNotExhaustMemory) {
  // 40,000 frames of 5 joints: 8 MB, and half a gigabyte at 30 fps.
  const Clip sparse(make_tree(), {1, 1}, 40'000);
  const auto result = resample(sparse, kRate30);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::kInput);
  EXPECT_THAT(result.error().message, HasSubstr("would make 1199971 frames from 40000"));
  // As sparse but short; as long but dense.
  EXPECT_EQ(resampled(Clip(make_tree(), {1, 1}, 1000), kRate30).frame_count(), 29'971);
  EXPECT_EQ(resampled(Clip(make_tree(), {10, 1}, 40'000), kRate30).frame_count(), 119'998);
}

TEST(ResampledFrameCount, TenSecondClipsTo30) {
  const struct {
    double fps;
    int frames_at_30;
  } rows[] = {{24, 301}, {25, 301},  {30, 301},     {50, 301},  {59.94, 300},
              {60, 301}, {100, 301}, {119.88, 300}, {120, 301}, {250, 301}};
  for (const auto& row : rows) {
    const int frame_count = static_cast<int>(std::floor(10.0 * row.fps)) + 1;
    const FrameRate rate = frame_rate_from_fps(row.fps);
    EXPECT_EQ(resampled_frame_count(frame_count, rate, kRate30), row.frames_at_30) << row.fps;
    const Clip clip(make_tree(), rate, frame_count);
    EXPECT_EQ(resampled(clip, kRate30).frame_count(), row.frames_at_30) << row.fps;
  }
}

TEST(ResampledFrameCount, IsExactForLongClips) {
  // A day and a second at film rate; with one frame less, the last sample is missing.
  const FrameRate film{24000, 1001};
  EXPECT_EQ(resampled_frame_count(24000 * 86 + 1, film, kRate30), 1001 * 86 * 30 + 1);
  EXPECT_EQ(resampled_frame_count(24000 * 86, film, kRate30), 1001 * 86 * 30 - 1);
  EXPECT_EQ(resampled_frame_count(0, film, kRate30), 0);
  EXPECT_EQ(resampled_frame_count(1, film, kRate30), 1);
  // 2e27 frames, which cannot be counted, must not become a small number.
  EXPECT_EQ(resampled_frame_count(2'000'000'000, FrameRate{1, 1'000'000'000},
                                  FrameRate{1'000'000'000, 1}),
            std::numeric_limits<std::int64_t>::max());
}

TEST(ResampledFrameCount, ToleratesRoundingOfTheDuration) {
  constexpr FrameRate kOne{1, 1};
  EXPECT_EQ(resampled_frame_count(2, FrameRate{1'000'000'000, 999'999'999}, kOne), 2);
  EXPECT_EQ(resampled_frame_count(2, FrameRate{1'000'000'000, 999'999'998}, kOne), 1);
}

TEST(Resample, EqualRatesCopyBitForBit) {
  Clip clip = make_clip(frame_rate_from_frame_time(0.033333), 101, tone(3.0));
  clip.rotations(50)[1].coeffs() *= -1.0;
  const Clip same = resampled(clip, kRate30);
  EXPECT_TRUE(same_bits(same, clip));
  EXPECT_EQ(same.rate(), kRate30);

  // The literal rate of such a file would drift by 1e-5.
  Clip literal = clip;
  literal.set_rate(FrameRate{1'000'000, 33'333});
  const Clip snapped = resampled(literal, kRate30);
  EXPECT_TRUE(same_bits(snapped, clip));
  EXPECT_EQ(snapped.rate(), kRate30);
}

TEST(Resample, IntegerRatiosWithoutFilterPickFrames) {
  const Clip clip = make_clip(k120, 404, [](double t) { return 5.0 * t + std::cos(40.0 * t); });
  for (const auto interpolation : {Interpolation::kLinear, Interpolation::kCubic}) {
    const Clip picked = resampled(clip, kRate30, {interpolation, false});
    ASSERT_EQ(picked.frame_count(), 101);
    for (int i = 0; i < 101; ++i) EXPECT_TRUE(same_bits(picked, i, clip, 4 * i)) << i;
  }
}

TEST(Resample, AccurateForASineFrom24To30) {
  const Clip clip = make_clip(kRate24, 241, tone(3.0));
  const Clip cubic = resampled(clip, kRate30);
  const Clip linear = resampled(clip, kRate30, kLinearOptions);
  ASSERT_EQ(cubic.frame_count(), 301);
  // Per unit of amplitude: the second component has an amplitude of 2.
  EXPECT_LT(translation_error(cubic, tone(3.0), 0, 301) / 2.0, 0.007);
  EXPECT_LT(translation_error(cubic, tone(3.0), 5, 296) / 2.0, 0.0012);
  EXPECT_LT(rotation_error(cubic, tone(3.0), 0, 301), 0.007);
  EXPECT_LT(rotation_error(cubic, tone(3.0), 5, 296), 0.0012);
  EXPECT_NEAR(translation_error(linear, tone(3.0), 0, 301) / 2.0, 0.068, 0.005);
  EXPECT_NEAR(rotation_error(linear, tone(3.0), 0, 301), 0.068, 0.005);
}

TEST(Resample, DampsTremorBeforeDecimating) {
  for (const double frequency : {20.0, 25.0}) {
    const Clip clip = make_clip(k120, 481, tone(frequency, 0.1));
    const auto still = [](double) { return 0.0; };
    const Clip damped = resampled(clip, kRate30);
    ASSERT_EQ(damped.frame_count(), 121);
    EXPECT_LT(translation_error(damped, still, 0, 121), 0.2 * 1e-3) << frequency;
    EXPECT_LT(rotation_error(damped, still, 0, 121), 0.1 * 1e-3) << frequency;
    // Without the filter, it aliases with full amplitude into a slow tremor.
    const Clip aliased = resampled(clip, kRate30, kPlainOptions);
    EXPECT_GT(translation_error(aliased, still, 0, 121), 0.2 * 0.8) << frequency;
  }
}

TEST(Resample, PreservesMotionWhenDecimating) {
  for (const double frequency : {0.5, 3.0, 8.0}) {
    const auto motion = tone(frequency, 0.1);
    const Clip clip = make_clip(k120, 481, motion);
    const Clip slow = resampled(clip, kRate30);
    const double part = frequency < 8.0 ? 1e-3 : 0.02;
    EXPECT_LT(translation_error(slow, motion, 0, 121), 0.2 * part) << frequency;
    EXPECT_LT(rotation_error(slow, motion, 0, 121), 0.1 * part) << frequency;
  }
}

TEST(Resample, DoesNotDelayRamps) {
  const auto ramp = [](double t) { return 0.4 + 7.0 * t; };  // several turns as a rotation
  for (const double fps : {23.976, 24.0, 25.0, 50.0, 59.94, 60.0, 100.0, 119.88, 120.0, 250.0}) {
    const FrameRate rate = frame_rate_from_fps(fps);
    const Clip clip = make_clip(rate, static_cast<int>(4.0 * fps), ramp);
    for (const auto interpolation : {Interpolation::kLinear, Interpolation::kCubic}) {
      for (const bool antialias : {false, true}) {
        const Clip output = resampled(clip, kRate30, {interpolation, antialias});
        EXPECT_GT(output.frame_count(), 115) << fps;
        EXPECT_LT(translation_error(output, ramp, 0, output.frame_count()), 1e-11) << fps;
        EXPECT_LT(rotation_error(output, ramp, 0, output.frame_count()), 1e-11) << fps;
      }
    }
  }
}

TEST(Resample, LongClipsDoNotDrift) {
  const auto ramp = [](double t) { return t; };
  const FrameRate film{24000, 1001};
  const Clip clip = make_clip(film, 10'000, ramp);
  const Clip output = resampled(clip, kRate30);
  EXPECT_EQ(output.frame_count(), resampled_frame_count(10'000, film, kRate30));
  EXPECT_LT(translation_error(output, ramp, 0, output.frame_count()), 1e-10);
}

TEST(Resample, IgnoresQuaternionSignFlips) {
  const Clip clip = make_clip(k120, 241, [](double t) { return 6.0 * t + std::sin(9.0 * t); });
  Clip flipped = clip;
  for (int frame = 1; frame < 241; ++frame) {
    for (std::size_t joint = 0; joint < 5; ++joint) {
      auto& q = flipped.rotations(frame)[joint];
      if ((frame * 7 + joint) % 3 == 0) q.coeffs() = -q.coeffs();
    }
  }
  for (const FrameRate rate : {kRate30, FrameRate{50, 1}, FrameRate{200, 1}}) {
    for (const auto& options : {ResampleOptions{}, kLinearOptions, kPlainOptions}) {
      EXPECT_TRUE(same_bits(resampled(clip, rate, options), resampled(flipped, rate, options)));
    }
  }
}

TEST(Resample, RoundTripIsAccurate) {
  const auto motion = tone(1.0);
  const Clip clip = make_clip(kRate30, 121, motion);
  // Every fourth sample on the way up is a frame of the source.
  const Clip up = resampled(clip, k120);
  ASSERT_EQ(up.frame_count(), 481);
  EXPECT_TRUE(same_bits(resampled(up, kRate30, kPlainOptions), clip));
  const Clip back = resampled(up, kRate30);
  EXPECT_LT(translation_error(back, motion, 0, 121), 2e-3);
  EXPECT_LT(rotation_error(back, motion, 0, 121), 1e-3);

  const Clip slow = make_clip(kRate24, 97, motion);
  const Clip there = resampled(resampled(slow, kRate30), kRate24, kPlainOptions);
  ASSERT_EQ(there.frame_count(), 97);
  EXPECT_LT(translation_error(there, motion, 0, 97), 2e-4);
  EXPECT_LT(rotation_error(there, motion, 0, 97), 1e-4);
}

TEST(Resample, HandlesShortClips) {
  for (const FrameRate rate : {FrameRate{10, 1}, kRate24, k60, k120, FrameRate{100'000'000, 1}}) {
    for (const auto& options : {ResampleOptions{}, kLinearOptions, kPlainOptions}) {
      const Clip none = resampled(Clip(make_tree(), rate, 0), kRate30, options);
      EXPECT_EQ(none.frame_count(), 0);
      EXPECT_EQ(none.rate(), kRate30);
      const auto shifted = [](double t) { return 0.5 + t; };
      const Clip one = make_clip(rate, 1, shifted);
      EXPECT_LT(rotation_error(resampled(one, kRate30, options), shifted, 0, 1), 1e-15);
      EXPECT_EQ(resampled(one, kRate30, options).frame_count(), 1);
      for (const int count : {2, 3, 4, 5}) {
        const Clip output = resampled(make_clip(rate, count, shifted), kRate30, options);
        EXPECT_EQ(output.frame_count(), resampled_frame_count(count, rate, kRate30));
        EXPECT_LT(translation_error(output, shifted, 0, output.frame_count()), 1e-14);
        EXPECT_LT(rotation_error(output, shifted, 0, output.frame_count()), 1e-14);
      }
    }
  }
}

TEST(Resample, IsDeterministicAndKeepsTheSource) {
  const Clip clip = make_clip(k60, 100, tone(2.0));
  const Clip kept = clip;
  EXPECT_TRUE(same_bits(resampled(clip, kRate24), resampled(clip, kRate24)));
  EXPECT_TRUE(same_bits(clip, kept));
}

TEST(Resample, QuaternionsStayUnit) {
  const Clip clip = make_clip(k120, 241, tone(11.0, 2.0));
  const Clip output = resampled(clip, kRate30);
  for (int frame = 0; frame < output.frame_count(); ++frame) {
    for (const auto& q : std::as_const(output).rotations(frame)) EXPECT_NEAR(q.norm(), 1.0, 1e-14);
  }
}

TEST(Resample, RejectsExtremeRates) {
  const Clip stretched = make_clip(FrameRate{1, 1'000'000}, 3, tone(1.0));
  const auto result = resample(stretched, kRate30);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::kInput);
  EXPECT_THAT(result.error().message, HasSubstr("60000001 frames from 3"));
  // A single frame has zero duration at any rate.
  EXPECT_EQ(resampled(cut(stretched, 0, 1), kRate30).frame_count(), 1);

  const Clip slow = make_clip(FrameRate{1, 1}, 20'000, tone(1.0));
  EXPECT_FALSE(resample(slow, FrameRate{600, 1}).has_value());
  EXPECT_TRUE(resample(cut(slow, 0, 10), FrameRate{600, 1}).has_value());
}

}  // namespace
}  // namespace retarget
