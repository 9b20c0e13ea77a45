#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

namespace retarget {

/// Taps of a linear-phase low-pass filter: a sinc cut off by a Kaiser window.
///
/// @param cutoff      frequency of half amplitude, in cycles per sample, in (0, 0.5]
/// @param half_width  taps on each side of the middle one, >= 0
/// @param beta        shape of the Kaiser window; 6 keeps the stop band near 1e-3 and below
/// @return 2 * half_width + 1 taps, symmetric, with sum 1: a constant passes unchanged
[[nodiscard]] std::vector<double> design_low_pass(double cutoff, int half_width, double beta = 6.0);

/// The low-pass filter to apply before taking one sample out of `ratio` (input rate / output
/// rate, > 1), built so that its response is always the same in relation to the output rate:
/// cut-off at 0.4 of it, 6 output samples on each side. From 120 to 30 Hz these are 49 taps with
/// a gain of 0.988 at 8 Hz, 0.5 at 12 Hz, 0.05 at 15 Hz and 1e-3 or less from 20 Hz on.
///
/// Ratios above 170 get no wider filter (1024 taps on each side): work and memory stay bounded
/// whatever rate a file claims, and aliases beyond that ratio are damped less.
[[nodiscard]] std::vector<double> anti_alias_taps(double ratio);

/// Filters a track of points without delay. What comes out are the samples 0, stride, 2 stride, ...
/// of the filtered track.
///
/// Before its first and after its last sample the track is continued by its reflection in that
/// sample (as often as a short track needs): position and slope go on smoothly, so constants and
/// ramps pass unchanged up to the very ends, and the first and last sample stay as they are. A
/// single sample is a constant.
/// @param taps    symmetric, odd in number
/// @param stride  at least 1
[[nodiscard]] std::vector<Eigen::Vector3d> low_pass(std::span<const Eigen::Vector3d> points,
                                                    std::span<const double> taps,
                                                    std::size_t stride = 1);

/// Filters a track of unit quaternions without delay, with the stride of the filter of points.
///
/// @pre sign-continuous: neighbours have a dot product >= 0
///
/// The four components are filtered and the sum is brought back to unit length. Against a filter
/// of rotation vectors around a local mean this has no limit on how far a joint turns within the
/// filter's reach, and a constant angular velocity about a fixed axis passes unchanged however
/// fast it is: its components are tones of one frequency that are only scaled alike. For an
/// oscillation of 0.5 rad at 3 Hz the difference between the two is below 1e-3 rad.
/// Ends are continued by point reflection of the rotations, q0 q(k)^-1 q0. Where the sum vanishes
/// (turns beyond any motion), the sample stays as it is.
[[nodiscard]] std::vector<Eigen::Quaterniond> low_pass(
    std::span<const Eigen::Quaterniond> rotations, std::span<const double> taps,
    std::size_t stride = 1);

}  // namespace retarget
