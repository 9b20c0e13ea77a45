#include "human/gait/track_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "retarget/so3.h"
#include "support/angles.h"
#include "support/normal_numbers.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kNoiseFrameTime = 1.0 / 30.0;

// A joint that swings by 20 degrees every two seconds.
std::vector<Quaterniond> swing(int frames = 300, double degrees = 20.0, double hertz = 0.5) {
  std::vector<Quaterniond> rotations;
  for (int i = 0; i < frames; ++i) {
    const double angle =
        degrees * kDegree * std::sin(2.0 * std::numbers::pi * hertz * i * kNoiseFrameTime);
    rotations.push_back(exp_so3(Vector3d(0.8 * angle, 0.0, 0.6 * angle)));
  }
  return rotations;
}

// Errors with a correlation time of 0.3 s and this RMS angle about each axis, degrees.
std::vector<Quaterniond> with_noise(std::vector<Quaterniond> rotations, double degrees) {
  NormalNumbers normal(7);
  const double keep = std::exp(-kNoiseFrameTime / 0.3);
  Vector3d error = Vector3d::Zero();
  for (Quaterniond& rotation : rotations) {
    const Vector3d fresh = normal.next_vector();
    error = keep * error + std::sqrt(1.0 - keep * keep) * degrees * kDegree * fresh;
    rotation = rotation * exp_so3(error);
  }
  return rotations;
}

// Independent errors of this RMS angle about each axis, degrees.
std::vector<Quaterniond> with_independent_errors(std::vector<Quaterniond> rotations,
                                                 double degrees) {
  NormalNumbers normal(5);
  for (Quaterniond& rotation : rotations) {
    const Vector3d error = normal.next_vector();
    rotation = rotation * exp_so3(degrees * kDegree * error);
  }
  return rotations;
}

template <typename Track>
Track best_smooth(const Track& track, const TrackNoise& noise, bool white,
                  double frame_time = kNoiseFrameTime) {
  const auto cutoff = best_cutoff(track, NoisePower::of(noise, white), frame_time, 1.5);
  return cutoff ? smoothed(track, smoothing_strength(*cutoff, frame_time)) : track;
}

double cutoff_of(const std::vector<Quaterniond>& rotations, bool white) {
  const NoisePower power = NoisePower::of(measure_noise(rotations), white);
  return best_cutoff(rotations, power, kNoiseFrameTime, 1.5).value_or(INFINITY);
}

double mean_change(const std::vector<Quaterniond>& rotations) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 2 < rotations.size(); ++i) {
    sum += (log_so3(rotations[i + 1].conjugate() * rotations[i + 2]) -
            log_so3(rotations[i].conjugate() * rotations[i + 1]))
               .norm();
  }
  return sum / static_cast<double>(rotations.size() - 2);
}

TEST(TrackNoise, IgnoresMovement) {
  const TrackNoise noise = measure_noise(swing());
  EXPECT_TRUE(noise.moves);
  EXPECT_GT(noise.correlation, 0.5);
  EXPECT_LT(noise.step, 1e-3);
  EXPECT_FALSE(noise.exceeds(kLargeStep));
  EXPECT_FALSE(noise.may_exceed(kSmallStep));
}

double rms_error(const std::vector<Quaterniond>& a, const std::vector<Quaterniond>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += log_so3(a[i].conjugate() * b[i]).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// A knee in walking bends with harmonics of the step's frequency.
TEST(TrackNoise, SmoothingKeepsTheStepsOfAKnee) {
  std::vector<Quaterniond> knee;
  for (int i = 0; i < 300; ++i) {
    const double phase = 2.0 * std::numbers::pi * i * kNoiseFrameTime;
    const double angle = 20.0 * std::sin(phase) + 15.0 * std::sin(2.0 * phase + 1.0) +
                         8.0 * std::sin(3.0 * phase + 2.0);
    knee.push_back(exp_so3(Vector3d(0.0, 0.0, angle * kDegree)));
  }
  const auto noisy = with_noise(knee, 5.0);
  const TrackNoise noise = measure_noise(noisy);
  const auto smooth = best_smooth(noisy, noise, false);
  EXPECT_LT(rms_error(knee, smooth), rms_error(knee, noisy));
  EXPECT_LT(mean_change(smooth), 0.7 * mean_change(noisy));
}

TEST(TrackNoise, FastMovementsMaskIt) {
  const auto fast = with_noise(swing(300, 40.0, 1.0), 1.0);
  const TrackNoise noise = measure_noise(fast);
  EXPECT_FALSE(noise.exceeds(kLargeStep));
  EXPECT_TRUE(noise.may_exceed(kLargeStep));
  EXPECT_FALSE(measure_noise(swing(300, 40.0, 1.0)).may_exceed(kSmallStep));
}

TEST(TrackNoise, IsMeasuredForPositions) {
  std::vector<Vector3d> places;
  std::mt19937 random(3);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
  for (int i = 0; i < 300; ++i) {
    const double along = 0.3 * std::sin(0.1 * i);
    places.push_back(Vector3d(along, 0.0, 1.0) + 0.02 * Vector3d(uniform(), uniform(), uniform()));
  }
  const TrackNoise noise = measure_noise(places);
  EXPECT_TRUE(noise.exceeds(0.005));
  double before = 0.0, after = 0.0;
  const auto smooth = best_smooth(places, noise, true);
  for (int i = 0; i < 300; ++i) {
    const Vector3d place(0.3 * std::sin(0.1 * i), 0.0, 1.0);
    before += (places[i] - place).norm();
    after += (smooth[i] - place).norm();
  }
  EXPECT_LT(after, 0.6 * before);
}

TEST(TrackNoise, IsZeroForStillJointsAndShortTracks) {
  const std::vector<Quaterniond> still(100, Quaterniond::Identity());
  EXPECT_FALSE(measure_noise(still).moves);
  EXPECT_FALSE(measure_noise(with_noise(swing(8), 5.0)).moves);
}

TEST(TrackNoise, IsMeasured) {
  const TrackNoise noise = measure_noise(with_noise(swing(), 2.0));
  EXPECT_TRUE(noise.exceeds(kLargeStep));
  EXPECT_LT(noise.correlation, -0.35);
  // Three axes, each of which changes by sqrt(2 (1 - keep)) of the error.
  const double step = std::sqrt(6.0 * (1.0 - std::exp(-kNoiseFrameTime / 0.3))) * 2.0 * kDegree;
  EXPECT_NEAR(noise.step, step, 0.25 * step);
}

TEST(TrackNoise, SmallNoiseIsKeptUnlessOtherTracksAreNoisy) {
  const TrackNoise noise = measure_noise(with_noise(swing(), 0.3));
  EXPECT_FALSE(noise.exceeds(kLargeStep));
}

TEST(TrackNoise, SmoothingFollowsTheMovement) {
  const std::vector<Quaterniond> clean = swing(300, 40.0, 1.0), noisy = with_noise(clean, 2.0);
  const TrackNoise noise = measure_noise(noisy);
  const double cutoff = cutoff_of(noisy, false);
  EXPECT_GT(cutoff, 1.5);
  EXPECT_LT(cutoff, 6.0);
  const std::vector<Quaterniond> smooth = best_smooth(noisy, noise, false);
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    before += clean[i].angularDistance(noisy[i]);
    after += clean[i].angularDistance(smooth[i]);
  }
  EXPECT_LT(after, before);
  EXPECT_LT(mean_change(smooth), 1.2 * mean_change(clean));
  EXPECT_GT(mean_change(noisy), 1.8 * mean_change(clean));
}

TEST(TrackNoise, IsWhiteIfErrorsAreIndependent) {
  EXPECT_TRUE(has_white_noise({measure_noise(with_independent_errors(swing(), 1.0))}));
  EXPECT_FALSE(has_white_noise({measure_noise(with_noise(swing(), 2.0))}));
  EXPECT_FALSE(has_white_noise({}));
  // Three axes.
  const NoisePower power =
      NoisePower::of(measure_noise(with_independent_errors(swing(), 1.0)), true);
  EXPECT_EQ(power.walk, 0.0);
  EXPECT_NEAR(std::sqrt(power.white), std::sqrt(3.0) * kDegree, 0.15 * kDegree);
}

// Tracks of random errors about three axes.
std::vector<TrackNoise> noises_of_errors(NormalNumbers& normal, int tracks, int frames,
                                         bool accumulate) {
  std::vector<TrackNoise> noises;
  for (int track = 0; track < tracks; ++track) {
    std::vector<Vector3d> places;
    Vector3d last = Vector3d::Zero();
    for (int frame = 0; frame < frames; ++frame) {
      Vector3d error = normal.next_vector();
      if (accumulate) error += last;
      last = error;
      places.push_back(error);
    }
    noises.push_back(measure_noise(places));
  }
  return noises;
}

TEST(TrackNoise, AccumulatedErrorsAreNotWhiteInShortClips) {
  constexpr int kClips = 100;
  NormalNumbers normal(3);
  for (const int tracks : {3, 20}) {
    for (const int frames : {30, 45, 60, 90, 300}) {
      int wrong = 0, right = 0;
      for (int clip = 0; clip < kClips; ++clip) {
        wrong += has_white_noise(noises_of_errors(normal, tracks, frames, true)) ? 1 : 0;
        right += has_white_noise(noises_of_errors(normal, tracks, frames, false)) ? 1 : 0;
      }
      EXPECT_LE(wrong, 4) << tracks << ' ' << frames;
      // If in doubt, errors accumulate.
      EXPECT_GE(right, tracks < 20 ? 60 : 98) << tracks << ' ' << frames;
    }
  }
}

TEST(TrackNoise, IndependentErrorsDoNotAlternateRegularly) {
  NormalNumbers normal(3);
  for (const int frames : {30, 60, 300}) {
    for (const TrackNoise& noise : noises_of_errors(normal, 200, frames, false)) {
      EXPECT_FALSE(noise.alternates()) << frames;
    }
    // Along one axis, the correlations scatter more.
    int regular = 0;
    for (int track = 0; track < 200; ++track) {
      std::vector<Vector3d> heights;
      for (int frame = 0; frame < frames; ++frame) heights.emplace_back(0.0, 0.0, normal.next());
      regular += measure_noise(heights).alternates() ? 1 : 0;
    }
    EXPECT_LE(regular, 2) << frames;
  }
}

// The best filter is not worse than none, whatever the movement and the noise.
TEST(TrackNoise, SmoothingNeverHarmsTracksWithWhiteNoise) {
  for (const double hertz : {0.5, 1.0, 2.0}) {
    const std::vector<Quaterniond> clean = swing(300, 30.0, hertz);
    for (const double degrees : {0.1, 0.3, 1.0, 4.0}) {
      const std::vector<Quaterniond> noisy = with_independent_errors(clean, degrees);
      const auto smooth = best_smooth(noisy, measure_noise(noisy), true);
      EXPECT_LE(rms_error(clean, smooth), rms_error(clean, noisy)) << hertz << ' ' << degrees;
    }
  }
}

// More frames with the same noise contain more of the movement.
TEST(TrackNoise, HigherRatesLeaveLessWhiteNoise) {
  double before = INFINITY;
  for (const int factor : {1, 2, 4}) {
    const double frame_time = kNoiseFrameTime / factor;
    const std::vector<Quaterniond> clean = swing(300 * factor, 30.0, 2.0 / factor);
    const std::vector<Quaterniond> noisy = with_independent_errors(clean, 1.0);
    const TrackNoise noise = measure_noise(noisy);
    const double error = rms_error(clean, best_smooth(noisy, noise, true, frame_time));
    EXPECT_LT(error, 0.85 * before);
    before = error;
  }
}

TEST(TrackNoise, RestIsWhatSmoothingLeaves) {
  const NoisePower white{1.0, 0.0}, walk{0.0, 1.0};
  const double strength = smoothing_strength(3.0, kNoiseFrameTime);
  EXPECT_LT(rest_of(white, strength, kNoiseFrameTime).speed,
            0.6 * rest_of(white, 0.0, kNoiseFrameTime).speed);
  EXPECT_EQ(rest_of(white, strength, kNoiseFrameTime).wander, 0.0);
  EXPECT_NEAR(rest_of(walk, strength, kNoiseFrameTime).wander, std::sqrt(30.0 / 6.0), 1e-9);
}

// Velocities of such tracks change in few frames, like those of noise.
TEST(TrackNoise, InterpolatedTracksHaveNone) {
  const std::vector<Quaterniond> knots = with_independent_errors(swing(100), 2.0);
  for (const int parts : {2, 3, 4}) {
    std::vector<Quaterniond> track;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      for (int part = 0; part < parts; ++part) {
        track.push_back(knots[i].slerp(static_cast<double>(part) / parts, knots[i + 1]));
      }
    }
    EXPECT_FALSE(measure_noise(track).moves) << parts;
  }
  EXPECT_TRUE(measure_noise(knots).moves);
}

TEST(TrackNoise, StrongerNoiseIsSmoothedMore) {
  const auto cutoff = [](double degrees) {
    return cutoff_of(with_noise(swing(300, 40.0, 1.0), degrees), false);
  };
  EXPECT_LT(cutoff(4.0), cutoff(1.0));
}

}  // namespace
}  // namespace retarget
