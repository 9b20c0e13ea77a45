#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "retarget/motion.h"

namespace retarget {

/// Evenly from the first frame to the last.
/// @param poses  at least one; no more than there are frames are taken.
[[nodiscard]] std::vector<int> spread_frames(int frame_count, int poses);

/// Where the robot faces on the whole in these frames, of any length: x is ahead in every robot's root.
[[nodiscard]] Eigen::Vector3d facing(const RobotClip& motion, const std::vector<int>& frames);

/// What a row of a strip shows from below to above: metres over the floor.
struct RowHeights {
  double low = 0.0, high = 0.0;
  bool has_floor = true;  ///< Whether 0 is between them.
};

/// Down (or up) to the floor where that is no farther from the figures than `body`; else the figures
/// alone, so that the height of a picture does not hang on where in the world a motion is.
/// @param figures  of a row; not empty.
/// @param body     height of the highest row's figures.
[[nodiscard]] RowHeights row_heights(const Eigen::AlignedBox2d& figures, double body);

}  // namespace retarget
