#pragma once

#include <span>

namespace retarget {

/// Computes the sines and cosines of many angles in vectors; the same bits as portable::sin_cos.
/// @param angles         radians.
/// @param sines, cosines  angles.size() values each.
void sin_cos_all(std::span<const double> angles, std::span<double> sines,
                 std::span<double> cosines);

}  // namespace retarget
