#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// Removes the slope of a floor from the heights of a body's lowest joint: subtracts the plane over
/// the horizontal positions that fits the heights best (damped least squares). World coordinates of
/// video estimates are tilted by a few degrees, and people walk on slopes. Leaves the heights
/// unchanged if the plane is steeper than 20 degrees, because bodies do not walk there.
/// @param heights  along the axis `up`, by pose; in legs
/// @param places   positions of the hips, by pose; in legs
/// @param up       index of the up axis
[[nodiscard]] std::vector<double> without_slope(std::vector<double> heights,
                                                const std::vector<Eigen::Vector3d>& places, int up);

}  // namespace retarget
