#pragma once

#include <span>

namespace retarget {

/// Movement of two shapes relative to each other in one step above which they may pass through each
/// other between the frames, metres. Overlaps of slower shapes are at most 3 cm deeper than in a
/// frame.
inline constexpr double kPassing = 0.06;

/// Computes the configuration half-way between two frames: the means of the positions, with the
/// root quaternion normalised.
/// @param from, to, half_way  configurations in Robot's layout.
void half_way_between(std::span<const double> from, std::span<const double> to,
                      std::span<double> half_way);

}  // namespace retarget
