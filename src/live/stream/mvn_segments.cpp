#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string_view>

#include "live/stream/mvn_segments.h"

namespace retarget {
namespace {

// The corresponding segment of the other side; the same index if there is none.
std::size_t mirrored_segment(std::size_t segment) {
  constexpr std::string_view kRight = "Right", kLeft = "Left";
  const std::string_view name = kMvnSegments[segment].name;
  if (!name.starts_with(kRight)) return segment;
  const auto other = mvn_segment(std::string(kLeft).append(name.substr(kRight.size())));
  return other.value_or(segment);
}

}  // namespace

std::string mvn_body_fault(const MvnOffsets& offsets) {
  constexpr double kLongest = 1.0;  // metres
  constexpr double kDifference = 0.03,
                   kPerLength = 0.3;  // Side tolerance: metres, fraction of the length.
  for (std::size_t i = 1; i < kMvnSegmentCount; ++i) {
    const double length = offsets[i].norm();
    // Negated, so that NaN is a fault.
    if (!(length <= kLongest)) {
      return fmt::format("segment {}: {:.2f} m from its parent", kMvnSegments[i].name, length);
    }
    const double other = offsets[mirrored_segment(i)].norm();
    if (std::abs(length - other) > kDifference + kPerLength * std::max(length, other)) {
      return fmt::format("segment {}: {:.2f} m from its parent, on the other side {:.2f} m",
                         kMvnSegments[i].name, length, other);
    }
  }
  return {};
}

}  // namespace retarget
