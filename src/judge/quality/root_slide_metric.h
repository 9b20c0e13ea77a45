#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace retarget {

/// Mean horizontal speed at which a root drifts from its target path, m/s, measured over two
/// seconds or over the whole of shorter clips. Sway of the body averages out over that time.
/// Nothing for a single frame.
/// @param found, wanted  positions by frame, world, metres.
[[nodiscard]] std::optional<double> root_slide(const std::vector<Eigen::Vector3d>& found,
                                               const std::vector<Eigen::Vector3d>& wanted,
                                               double fps);

}  // namespace retarget
