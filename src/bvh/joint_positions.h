#pragma once

#include <vector>

#include "retarget/clip.h"

namespace retarget {

/// Which joints' position channels were read as something else than positions.
struct PositionReading {
  std::vector<int> unmoved;  ///< 0 in every frame: the OFFSET counts.
  std::vector<int> changes;  ///< Small beside the OFFSET in every frame: added to it.
};

/// A position channel stands for its component of OFFSET, but not every exporter means that: some
/// write zeros for joints that stay at their offset (MakeHuman's files), or rounding noise, or what
/// is to be added to it. A joint below the root of which the positions stay below a twentieth of
/// its OFFSET in all frames is such a one; where more than half of the joints are, so are
/// those of the others that are nearer to 0 than to their OFFSET. Their OFFSET is added.
PositionReading read_positions_beside_offsets(Clip& clip);

/// Whether a joint's positions would be read as changes to its OFFSET, or as none at all: it is
/// below the root, and they stay near 0 beside it.
[[nodiscard]] bool has_positions_near_zero(const Clip& clip, int joint);

}  // namespace retarget
