#pragma once

#include <Eigen/Core>
#include <vector>

namespace retarget {

/// Removes the slow part of a horizontal drift that the noise of the legs explains: each stance adds
/// an error to it, so that its slow part wanders like the legs and not like the root. The travel of
/// the clip is then that of its root.
/// @param drift   error of the root by frame, z up
/// @param wander  RMS distance by which the noise moves standing feet within a second, in the same
///     unit
void keep_travel(std::vector<Eigen::Vector3d>& drift, double wander, double frame_time);

}  // namespace retarget
