#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Taps of a linear-phase low-pass filter: a sinc windowed by a Kaiser window.
///
/// @param cutoff      frequency of half amplitude, cycles per sample, in (0, 0.5].
/// @param half_width  taps on each side of the middle one, >= 0.
/// @param beta        shape of the Kaiser window; 6 keeps the stop band near 1e-3 and below.
/// @return 2 * half_width + 1 symmetric taps with sum 1, so that a constant passes unchanged.
[[nodiscard]] std::vector<double> design_low_pass(double cutoff, int half_width, double beta = 6.0);

/// Taps of the low-pass filter to apply before keeping one sample out of `ratio` (input rate /
/// output rate, > 1). Its response relative to the output rate is always the same: cutoff at 0.4 of
/// the output rate, 6 output samples on each side. From 120 to 30 Hz it has 49 taps and a gain of
/// 0.988 at 8 Hz, 0.5 at 12 Hz, 0.05 at 15 Hz and at most 1e-3 above 20 Hz.
///
/// Ratios above 170 get the same filter width (1024 taps on each side), which bounds work and
/// memory for any rate that a file claims. Aliasing is then attenuated less.
[[nodiscard]] std::vector<double> anti_alias_taps(double ratio);

/// Filters a track of points without delay. Returns the samples 0, stride, 2 stride, ... of the
/// filtered track.
///
/// Both ends are extended by point reflection about the first and the last sample (repeatedly for
/// short tracks). Position and slope continue smoothly, so constants and ramps pass unchanged up to
/// the ends, and the first and last samples do not change. A single sample counts as a constant.
/// @param taps    symmetric, odd in number.
/// @param stride  >= 1.
[[nodiscard]] std::vector<Eigen::Vector3d> low_pass(std::span<const Eigen::Vector3d> points,
                                                    std::span<const double> taps,
                                                    std::size_t stride = 1);

/// Filters a track of unit quaternions without delay; `stride` as for points.
///
/// @pre The track is sign-continuous: neighbours have a dot product >= 0.
///
/// Filters the four components and normalises the sum. Unlike a filter of rotation vectors about a
/// local mean, this has no limit on the rotation within the filter's width, and a constant angular
/// velocity about a fixed axis passes unchanged at any speed: its components are tones of a single
/// frequency that are all scaled alike. For an oscillation of 0.5 rad at 3 Hz, the two methods
/// differ by less than 1e-3 rad. The ends are extended by point reflection of the rotations,
/// q0 q(k)^-1 q0. Where the filtered sum vanishes (for rotations faster than any real motion), the
/// sample is left unchanged.
[[nodiscard]] std::vector<Eigen::Quaterniond> low_pass(
    std::span<const Eigen::Quaterniond> rotations, std::span<const double> taps,
    std::size_t stride = 1);

}  // namespace retarget
