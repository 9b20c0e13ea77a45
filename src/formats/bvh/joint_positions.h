#pragma once

#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Joints whose position channels do not hold positions.
struct PositionReading {
  std::vector<int> unmoved;  ///< 0 in every frame: the joint stays at its OFFSET.
  std::vector<int> changes;  ///< Small relative to the OFFSET in every frame: they are added to the
                             ///< OFFSET.
};

/// Corrects position channels that are relative to the OFFSET.
///
/// A position channel normally replaces its component of the OFFSET. Some exporters instead write
/// zeros for joints that stay at their offset (MakeHuman), rounding noise, or displacements from
/// the OFFSET. A joint below the root is treated as relative when its positions stay below a
/// twentieth of its OFFSET in all frames. If more than half of the joints are relative, so is each
/// other joint whose positions are on average nearer to 0 than to its OFFSET. The OFFSET is added
/// to the positions of relative joints.
PositionReading read_positions_beside_offsets(Clip& clip);

/// Whether the reader would treat a joint's positions as relative to its OFFSET: the joint is below
/// the root and its positions stay near 0 compared with the OFFSET.
[[nodiscard]] bool has_positions_near_zero(const Clip& clip, int joint);

}  // namespace retarget
