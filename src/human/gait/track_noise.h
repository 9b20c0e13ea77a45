#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace retarget {

/// Jitter of a track of rotations or positions, measured by changes of velocity between frames. In
/// a movement neighbouring changes are similar; in noise they alternate. Their correlation is -1/2
/// if errors accumulate (each frame's error is the last one's plus a random part), and -2/3 if
/// errors are independent.
struct TrackNoise {
  bool moves = false;
  double correlation = 0.0;  ///< Correlation of neighbouring changes.
  /// Correlation of neighbouring differences of changes: -2/3 and -3/4 for these errors.
  double sharp_correlation = 0.0;
  double step = 0.0;  ///< RMS change of the error per frame, rad or length.
  int samples = 0;    ///< Number of neighbours in the correlations.

  /// Returns whether the track has certain noise of more than this per frame.
  [[nodiscard]] bool exceeds(double step_limit) const;
  /// Weaker test for a track among noisy ones: fast movement hides noise from the changes.
  [[nodiscard]] bool may_exceed(double step_limit) const;
  /// Whether the changes alternate more regularly than those of independent errors, as in a track
  /// that vibrates or holds each value for two frames.
  [[nodiscard]] bool alternates() const;
};

/// Limits for rotations, rad: harmful to a robot's motion, and noise where other joints are noisy.
inline constexpr double kLargeStep = 0.3 * 3.14159265358979 / 180.0, kSmallStep = kLargeStep / 3.0;

/// A track that was interpolated linearly between fewer frames has no noise that can be measured:
/// its velocity changes only where two lines meet, like noise. Such a track does not move.
/// @param rotations  neighbours have a dot product >= 0.
[[nodiscard]] TrackNoise measure_noise(const std::vector<Eigen::Quaterniond>& rotations);
[[nodiscard]] TrackNoise measure_noise(const std::vector<Eigen::Vector3d>& places);

/// Whether the errors of jittery tracks are independent, rather than accumulated. Movement raises
/// correlations, so the tracks with the lowest ones decide. In short tracks the correlations
/// scatter, so they must be lower; if in doubt, errors accumulate.
[[nodiscard]] bool has_white_noise(const std::vector<TrackNoise>& jittery);

/// Power of a track's noise, summed over the axes, in squares of rad or of a length.
struct NoisePower {
  double white = 0.0;  ///< Variance of errors that are independent.
  double walk = 0.0;   ///< Variance of the changes, per frame, of errors that accumulate.

  /// Noise of the measured size.
  [[nodiscard]] static NoisePower of(const TrackNoise& noise, bool white);
};

/// The strength of smoothed() that has its gain of one half approximately at a frequency in Hz (at
/// a higher one near the Nyquist frequency).
[[nodiscard]] double smoothing_strength(double cutoff, double frame_time);

/// Noise that remains after smoothing: RMS speed over 1/15 s, as that of contacts, and RMS
/// distance of errors that accumulate from their mean over a second.
struct NoiseRest {
  double speed = 0.0, wander = 0.0;
};
[[nodiscard]] NoiseRest rest_of(const NoisePower& noise, double strength, double frame_time);

/// Returns the cutoff frequency in Hz, at least `slowest`, of the low-pass that leaves the least
/// error: the removed part of the movement and the remaining part of the noise. The power of the
/// noise and the removed part of the track are known, so this error can be estimated for any
/// movement (Stein's unbiased risk estimate). Nothing if the track itself has the least error.
/// @param rotations  neighbours have a dot product >= 0.
[[nodiscard]] std::optional<double> best_cutoff(const std::vector<Eigen::Quaterniond>& rotations,
                                                const NoisePower& noise, double frame_time,
                                                double slowest);
[[nodiscard]] std::optional<double> best_cutoff(const std::vector<Eigen::Vector3d>& places,
                                                const NoisePower& noise, double frame_time,
                                                double slowest);

/// Applies a zero-phase low-pass filter.
/// @param rotations  neighbours have a dot product >= 0.
[[nodiscard]] std::vector<Eigen::Quaterniond> smoothed(std::vector<Eigen::Quaterniond> rotations,
                                                       double strength);
[[nodiscard]] std::vector<Eigen::Vector3d> smoothed(std::vector<Eigen::Vector3d> places,
                                                    double strength);

}  // namespace retarget
