#include "judge/quality/arm_jolts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "retarget/motion.h"

namespace retarget {
namespace {

constexpr double kJolt = 12.0;    // Change of a trunk line's angle within kWithin, degrees.
constexpr double kWithin = 0.1;   // Seconds.
constexpr double kArmOff = 25.0;  // Angle error of an upper arm, degrees.
constexpr double kApart = 0.5;    // Smallest time between two jolts, seconds.

// Largest value of the segments of one kind in frames [begin, begin + count).
double largest(std::span<const SegmentAngles> segments, bool of_arms, std::size_t begin,
               std::size_t count) {
  double most = 0.0;
  for (const SegmentAngles& segment : segments) {
    if (segment.is_upper_arm != of_arms) continue;
    const auto part = std::span(segment.angles).subspan(begin, count);
    most = std::max(most, *std::ranges::max_element(part));
  }
  return most;
}

double largest_change(std::span<const SegmentAngles> segments, std::size_t begin,
                      std::size_t within) {
  double most = 0.0;
  for (const SegmentAngles& segment : segments) {
    if (segment.is_upper_arm) continue;
    most = std::max(most, std::abs(segment.angles[begin + within] - segment.angles[begin]));
  }
  return most;
}

}  // namespace

void measure_arm_jolts(const ReportBuilder& draft, const Posture& posture,
                       std::span<const SegmentAngles> segments) {
  if (std::ranges::none_of(segments, &SegmentAngles::is_upper_arm)) return;
  const double fps = draft.clip.rate().fps();
  const auto frames_in = [fps](double seconds) {
    return static_cast<std::size_t>(std::max<std::int64_t>(1, std::llround(seconds * fps)));
  };
  const std::size_t within = frames_in(kWithin), apart = frames_in(kApart);
  constexpr std::size_t kNamed = 5;
  FaultList faults("arm_jolts", "deg");
  std::size_t last = 0;
  int jolts = 0;
  for (std::size_t i = 0; i + within < segments.front().angles.size(); ++i) {
    const auto first = static_cast<int>(i), last_frame = static_cast<int>(i + within);
    if (!posture.is_upright(first) || !posture.is_upright(last_frame)) continue;
    const double change = largest_change(segments, i, within);
    if (!(change > kJolt) || !(largest(segments, true, i, within + 1) > kArmOff)) continue;
    if (jolts == 0 || i > last + apart) ++jolts;
    last = i;
    faults.add("trunk", first, change);
  }
  faults.move_to(draft.report, kNamed);
  draft.set("arm_jolts", jolts);
}

}  // namespace retarget
