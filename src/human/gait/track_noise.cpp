#include "human/gait/track_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/math/banded_system.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Changes of a track's velocity between frames.
template <typename Track, typename Difference>
std::vector<Vector3d> velocity_changes(const Track& track, const Difference& difference) {
  std::vector<Vector3d> steps, changes;
  for (std::size_t i = 0; i + 1 < track.size(); ++i) {
    steps.push_back(difference(track[i], track[i + 1]));
  }
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) changes.push_back(steps[i + 1] - steps[i]);
  return changes;
}

// Whether a third of the changes that move the track are much smaller than one of their neighbours:
// the frame between is on the line between its neighbours. Noise hardly ever is.
// @param squares  of the changes
bool is_interpolated(const std::vector<double>& squares, double still) {
  constexpr double kMuchSmaller = 0.1 * 0.1;
  int lines = 0, moving = 0;
  for (std::size_t i = 1; i + 1 < squares.size(); ++i) {
    const double beside = std::max(squares[i - 1], squares[i + 1]);
    if (!(std::max(beside, squares[i]) > still)) continue;
    ++moving;
    if (squares[i] < kMuchSmaller * beside) ++lines;
  }
  return 3 * lines > moving;
}

// @param still  mean square of the changes of a resting track
template <typename Track, typename Difference>
TrackNoise noise_of(const Track& track, double still, const Difference& difference) {
  constexpr int kFewest = 12;
  TrackNoise noise;
  const std::vector<Vector3d> changes = velocity_changes(track, difference);
  if (static_cast<int>(changes.size()) < kFewest) return noise;
  std::vector<double> squares;
  squares.reserve(changes.size());
  for (const Vector3d& change : changes) squares.push_back(change.squaredNorm());
  // Ignore single jumps, because the noise is continuous.
  const double usual = percentile(squares, 90.0);
  if (!(usual > still) || is_interpolated(squares, still)) return noise;
  noise.moves = true;
  double product = 0.0, sum = 0.0, sharp_product = 0.0, sharp_sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i + 2 < changes.size(); ++i) {
    if (std::max({squares[i], squares[i + 1], squares[i + 2]}) > usual) continue;
    product += changes[i].dot(changes[i + 1]);
    sum += 0.5 * (squares[i] + squares[i + 1]);
    // Differences of changes contain even less of the movement.
    const Vector3d first = changes[i + 1] - changes[i], second = changes[i + 2] - changes[i + 1];
    sharp_product += first.dot(second);
    sharp_sum += 0.5 * (first.squaredNorm() + second.squaredNorm());
    ++count;
  }
  if (count < kFewest / 2 || !(sum > 0.0) || !(sharp_sum > 0.0)) return noise;
  noise.correlation = product / sum;
  noise.sharp_correlation = sharp_product / sharp_sum;
  // Neighbouring differences of changes share four times the squared error step.
  noise.step = std::sqrt(std::max(0.0, -0.25 * sharp_product / count));
  noise.samples = count;
  return noise;
}

// Power gain of the difference over some frames at a frequency, rad per frame.
double gain_of_difference(double frequency, double frames = 1.0) {
  return 2.0 - 2.0 * portable::sin_cos(frames * frequency).cosine;
}

// Mean of power(frequency, gain) over the spectrum of a sampled track. The frequency is in rad per
// frame, `gain` is that of smoothed() for an amplitude.
template <typename Power>
double mean_power(double strength, const Power& power) {
  constexpr int kCount = 512;
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double frequency = std::numbers::pi * (i + 0.5) / kCount;
    const double u = gain_of_difference(frequency);
    sum += power(frequency, 1.0 / (1.0 + strength * u * u));
  }
  return sum / kCount;
}

// Of the noise at a frequency, rad per frame.
double power_at(double frequency, const NoisePower& noise) {
  return noise.white + noise.walk / gain_of_difference(frequency);
}

// Mean product of the noise with its part that smoothing removes.
double removed_noise(const NoisePower& noise, double strength) {
  return mean_power(strength, [&](double frequency, double gain) {
    return (1.0 - gain) * power_at(frequency, noise);
  });
}

// Smooths the numbers of the values. @param numbers  returns those of a value, `count` in total.
template <typename Value, typename Numbers>
void smooth_numbers(std::vector<Value>& values, double strength, int count,
                    const Numbers& numbers) {
  std::vector<double> track(values.size());
  for (int part = 0; part < count; ++part) {
    for (std::size_t i = 0; i < track.size(); ++i) track[i] = numbers(values[i])[part];
    track = smoothed(track, strength);
    for (std::size_t i = 0; i < track.size(); ++i) numbers(values[i])[part] = track[i];
  }
}

// @param square_distance  of two values
template <typename Track, typename Distance>
std::optional<double> least_error(const Track& track, const NoisePower& noise, double frame_time,
                                  double slowest, const Distance& square_distance) {
  constexpr double kRatio = 1.2, kFastest = 0.4;  // Hz per Hz, periods per frame.
  double least = 0.0;                             // Without smoothing.
  std::optional<double> best;
  for (double cutoff = slowest; cutoff * frame_time < kFastest; cutoff *= kRatio) {
    const double strength = smoothing_strength(cutoff, frame_time);
    const Track smooth = smoothed(track, strength);
    double removed = 0.0;
    for (std::size_t i = 0; i < track.size(); ++i) removed += square_distance(track[i], smooth[i]);
    const double error =
        removed / static_cast<double>(track.size()) - 2.0 * removed_noise(noise, strength);
    if (!(error < least)) continue;
    least = error;
    best = cutoff;
  }
  return best;
}

}  // namespace

bool TrackNoise::exceeds(double step_limit) const {
  constexpr double kCorrelation = -0.25;
  return moves && correlation < kCorrelation && step > step_limit;
}

bool TrackNoise::may_exceed(double step_limit) const {
  constexpr double kCorrelation = -0.35;
  return moves && sharp_correlation < kCorrelation && step > step_limit;
}

bool TrackNoise::alternates() const {
  // The correlations of independent errors in one sample scatter by these values (Bartlett). All
  // errors may be along one axis.
  constexpr double kScatter = 0.55, kSharpScatter = 0.45, kDeviations = 3.0;
  const double deviations = kDeviations / std::sqrt(std::max(1, samples));
  return correlation < -2.0 / 3.0 - deviations * kScatter ||
         sharp_correlation < -3.0 / 4.0 - deviations * kSharpScatter;
}

TrackNoise measure_noise(const std::vector<Quaterniond>& rotations) {
  constexpr double kStill = 1e-12;
  return noise_of(rotations, kStill, [](const Quaterniond& from, const Quaterniond& to) {
    return log_so3(from.conjugate() * to);
  });
}

TrackNoise measure_noise(const std::vector<Vector3d>& places) {
  return noise_of(places, 0.0,
                  [](const Vector3d& from, const Vector3d& to) { return Vector3d(to - from); });
}

bool has_white_noise(const std::vector<TrackNoise>& jittery) {
  // Errors that accumulate are not below -1/2, apart from the scatter of finite tracks: 0.7 for one
  // sample, of which a track has three per frame. In simulations of such errors, the lowest tenth
  // of 1, 3 or 20 tracks of at least 30 frames is below the limit in at most 2 % of the clips.
  constexpr double kAccumulated = -0.5, kWhite = -0.54, kScatter = 0.7, kDeviations = 1.4;
  constexpr double kLowest = 10.0;  // Percent.
  std::vector<double> above;        // Correlations relative to their limits.
  for (const TrackNoise& noise : jittery) {
    const double scatter = kScatter / std::sqrt(3.0 * std::max(1, noise.samples));
    above.push_back(noise.correlation - std::min(kWhite, kAccumulated - kDeviations * scatter));
  }
  return !above.empty() && percentile(std::move(above), kLowest) < 0.0;
}

NoisePower NoisePower::of(const TrackNoise& noise, bool white) {
  // The largest tenth of the changes, which is not used, has this share of the power.
  constexpr double kOutliers = 0.25;
  // Neighbouring differences of changes share 15 times the variance of independent errors.
  constexpr double kShared = 15.0 / 4.0;
  const double power = noise.step * noise.step / (1.0 - kOutliers);
  return white ? NoisePower{power / kShared, 0.0} : NoisePower{0.0, power};
}

double smoothing_strength(double cutoff, double frame_time) {
  const double frequency = 2.0 * std::numbers::pi * cutoff * frame_time;
  const double square = frequency * frequency;
  return 1.0 / (square * square);
}

NoiseRest rest_of(const NoisePower& noise, double strength, double frame_time) {
  constexpr double kSpeedTime = 1.0 / 15.0, kWanderTime = 1.0;  // Seconds.
  const double frames = std::max(1.0, kSpeedTime / frame_time);
  const double square = mean_power(strength, [&](double frequency, double gain) {
    return gain * gain * power_at(frequency, noise) * gain_of_difference(frequency, frames);
  });
  // A random walk is on average this far from its mean over n steps: n / 6 squared steps.
  const double wander = noise.walk * kWanderTime / frame_time / 6.0;
  return {std::sqrt(square) / (frames * frame_time), std::sqrt(wander)};
}

std::optional<double> best_cutoff(const std::vector<Quaterniond>& rotations,
                                  const NoisePower& noise, double frame_time, double slowest) {
  // An angle is twice as large as the difference of quaternions.
  return least_error(rotations, noise, frame_time, slowest,
                     [](const Quaterniond& a, const Quaterniond& b) {
                       return 4.0 * (a.coeffs() - b.coeffs()).squaredNorm();
                     });
}

std::optional<double> best_cutoff(const std::vector<Vector3d>& places, const NoisePower& noise,
                                  double frame_time, double slowest) {
  return least_error(places, noise, frame_time, slowest,
                     [](const Vector3d& a, const Vector3d& b) { return (a - b).squaredNorm(); });
}

std::vector<Quaterniond> smoothed(std::vector<Quaterniond> rotations, double strength) {
  smooth_numbers(rotations, strength, 4,
                 [](Quaterniond& rotation) -> Eigen::Vector4d& { return rotation.coeffs(); });
  for (Quaterniond& rotation : rotations) rotation.normalize();
  return rotations;
}

std::vector<Vector3d> smoothed(std::vector<Vector3d> places, double strength) {
  smooth_numbers(places, strength, 3, [](Vector3d& place) -> Vector3d& { return place; });
  return places;
}

}  // namespace retarget
