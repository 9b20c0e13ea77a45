#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "live/stream/mvn_segments.h"

namespace retarget {

/// Offset of each segment from its parent, metres.
using MvnOffsets = std::array<Eigen::Vector3d, kMvnSegmentCount>;

/// Describes why the offsets are implausible for a person, for example because of damaged data;
/// empty if plausible.
[[nodiscard]] std::string mvn_body_fault(const MvnOffsets& offsets);

}  // namespace retarget
