#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "retarget/motion.h"

namespace retarget {

/// Returns the evenly spaced frames from the first to the last.
/// @param poses  at least one; limited to the number of frames.
[[nodiscard]] std::vector<int> spread_frames(int frame_count, int poses);

/// Returns the mean facing direction in these frames, not normalised; x is forward in every robot's
/// root.
[[nodiscard]] Eigen::Vector3d facing(const RobotClip& motion, const std::vector<int>& frames);

/// Vertical extent of a strip row, metres above the floor.
struct RowHeights {
  double low = 0.0, high = 0.0;
  bool has_floor = true;  ///< True if 0 lies within the extent.
};

/// Extends a row to the floor if the floor is no farther from the figures than `body`. Otherwise
/// shows only the figures, so that the picture's height does not depend on the motion's position in
/// the world.
/// @param figures  bounding box of the row; not empty.
/// @param body     height of the tallest row's figures, metres.
[[nodiscard]] RowHeights row_heights(const Eigen::AlignedBox2d& figures, double body);

}  // namespace retarget
