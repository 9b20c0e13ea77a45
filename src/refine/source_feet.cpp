#include "refine/source_feet.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

// Speeds are taken over two frames or over this time, whichever says slower: the short one sees a
// foot come to rest early at any frame rate, the long one is not misled by noise of fast sources.
constexpr double kSpeedTime = 1.0 / 15.0;

// m/s, over `half` frames on either side
double speed_over(const SourceFeet& source, int frame, int foot, int end, int half) {
  const int from = std::max(frame - half, 0), to = std::min(frame + half, source.frame_count() - 1);
  if (to == from) return 0.0;
  return (source.at(to, foot).end(end) - source.at(from, foot).end(end)).norm() /
         (source.frame_time * (to - from));
}

}  // namespace

double SourceFeet::speed(int frame, int foot, int end) const {
  const int half = static_cast<int>(std::lround(0.5 * kSpeedTime / frame_time));
  const double shortly = speed_over(*this, frame, foot, end, 1);
  return half <= 1 ? shortly : std::min(shortly, speed_over(*this, frame, foot, end, half));
}

}  // namespace retarget
