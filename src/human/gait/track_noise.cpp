#include "human/gait/track_noise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/math/banded_system.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kReach = 0.2;  // Window in seconds for the acceleration of the movement itself.

// Changes of a track's velocity, each over `reach` frames to either side.
template <typename Track, typename Difference>
std::vector<Vector3d> velocity_changes(const Track& track, std::size_t reach,
                                       const Difference& difference) {
  std::vector<Vector3d> steps, changes;
  for (std::size_t i = 0; i + reach < track.size(); ++i) {
    steps.push_back(difference(track[i], track[i + reach]));
  }
  for (std::size_t i = 0; i + reach < steps.size(); ++i) {
    changes.push_back(steps[i + reach] - steps[i]);
  }
  return changes;
}

double mean_square(const std::vector<Vector3d>& values) {
  double sum = 0.0;
  for (const Vector3d& value : values) sum += value.squaredNorm();
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

// @param still  mean square of the changes of a resting track
template <typename Track, typename Difference>
TrackNoise noise_of(const Track& track, double frame_time, double still,
                    const Difference& difference) {
  constexpr std::size_t kFewest = 12;
  TrackNoise noise;
  const std::vector<Vector3d> changes = velocity_changes(track, 1, difference);
  if (changes.size() < kFewest) return noise;
  std::vector<double> squares;
  squares.reserve(changes.size());
  for (const Vector3d& change : changes) squares.push_back(change.squaredNorm());
  // Ignore single jumps, because the noise is continuous.
  const double usual = percentile(squares, 90.0);
  if (!(usual > still)) return noise;
  noise.moves = true;
  double product = 0.0, sum = 0.0, sharp_product = 0.0, sharp_sum = 0.0;
  std::size_t count = 0;
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
  noise.step = std::sqrt(std::max(0.0, -0.25 * sharp_product / static_cast<double>(count)));
  const auto reach = static_cast<std::size_t>(std::max(1L, std::lround(kReach / frame_time)));
  const double frames = static_cast<double>(reach);
  const double seen = mean_square(velocity_changes(track, reach, difference));
  const double of_noise = 2.0 * frames * noise.step * noise.step;
  noise.acceleration = std::sqrt(std::max(0.1 * seen, seen - of_noise)) / (frames * frames);
  return noise;
}

double smoothing_strength(double cutoff, double frame_time) {
  const double frequency = 2.0 * std::numbers::pi * cutoff * frame_time;
  const double square = frequency * frequency;
  return 1.0 / (square * square);
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

TrackNoise measure_noise(const std::vector<Quaterniond>& rotations, double frame_time) {
  constexpr double kStill = 1e-12;
  return noise_of(rotations, frame_time, kStill,
                  [](const Quaterniond& from, const Quaterniond& to) {
                    return log_so3(from.conjugate() * to);
                  });
}

TrackNoise measure_noise(const std::vector<Vector3d>& places, double frame_time) {
  return noise_of(places, frame_time, 0.0,
                  [](const Vector3d& from, const Vector3d& to) { return Vector3d(to - from); });
}

double cutoff_for(const TrackNoise& noise, double frame_time, double slowest) {
  constexpr double kFastest = 6.0;  // Hz
  // Slow movements have more of the higher frequencies than their acceleration over kReach shows:
  // a factor of 2.2, up to a few Hz, gives the least errors of rotations with known noise.
  constexpr double kSharper = 2.2, kSharperUpTo = 4.5;
  if (!(noise.step > 0.0)) return kFastest;
  const double frequency = noise.acceleration / noise.step / (2.0 * std::numbers::pi * frame_time);
  const double sharper = std::max(frequency, std::min(kSharper * frequency, kSharperUpTo));
  return std::clamp(sharper, slowest, kFastest);
}

std::vector<Quaterniond> smoothed(const std::vector<Quaterniond>& rotations, double cutoff,
                                  double frame_time) {
  const double strength = smoothing_strength(cutoff, frame_time);
  std::vector<Quaterniond> result(rotations);
  std::vector<double> track(rotations.size());
  for (int part = 0; part < 4; ++part) {
    for (std::size_t i = 0; i < track.size(); ++i) track[i] = rotations[i].coeffs()[part];
    track = smoothed(track, strength);
    for (std::size_t i = 0; i < track.size(); ++i) result[i].coeffs()[part] = track[i];
  }
  for (Quaterniond& rotation : result) rotation.normalize();
  return result;
}

std::vector<Vector3d> smoothed(const std::vector<Vector3d>& places, double cutoff,
                               double frame_time) {
  const double strength = smoothing_strength(cutoff, frame_time);
  std::vector<Vector3d> result(places);
  std::vector<double> track(places.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < track.size(); ++i) track[i] = places[i][axis];
    track = smoothed(track, strength);
    for (std::size_t i = 0; i < track.size(); ++i) result[i][axis] = track[i];
  }
  return result;
}

}  // namespace retarget
