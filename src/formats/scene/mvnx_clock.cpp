#include "formats/scene/mvnx_clock.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "retarget/statistics.h"

namespace retarget {
namespace {

// Tolerance for the rounding of times to milliseconds.
constexpr double kRoundedMs = 1.01;
// Relative difference between a stated and a measured rate. MVN states 60 for 59.94.
constexpr double kSameMvnxRate = 0.01;

// The values of an attribute; empty if frames lack it or all are equal.
std::vector<double> values_of(const std::vector<MvnxStamp>& stamps,
                              std::optional<double> MvnxStamp::*attribute) {
  std::vector<double> values;
  for (const MvnxStamp& stamp : stamps) {
    if (!(stamp.*attribute)) return {};
    values.push_back(*(stamp.*attribute));
  }
  const bool is_constant =
      std::ranges::all_of(values, [&](double value) { return value == values.front(); });
  return is_constant ? std::vector<double>() : values;
}

// The first frame that does not follow the one before by the usual step; 0 if all do. A single
// late or early value changes two adjacent steps, which together are as long as usual.
std::size_t odd_frame(const std::vector<double>& values, double usual, double rounding) {
  const double allowed = std::max(0.51 * usual, rounding);
  const auto is_odd = [&](std::size_t from, std::size_t to) {
    const double expected = static_cast<double>(to - from) * usual;
    return std::abs(values[to] - values[from] - expected) > allowed;
  };
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] <= values[i - 1]) return i;
    if (!is_odd(i - 1, i)) continue;
    if (i > 1 && !is_odd(i - 2, i)) continue;
    if (i + 1 < values.size() && !is_odd(i - 1, i + 1)) continue;
    return i;
  }
  return 0;
}

double median_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  return median_in_place(steps);
}

}  // namespace

std::optional<MvnxClockFault> mvnx_clock_fault(const std::vector<MvnxStamp>& stamps,
                                               const std::optional<double>& fps) {
  const std::vector<double> times = values_of(stamps, &MvnxStamp::time);
  if (!times.empty()) {
    const double usual = median_step(times);
    if (const std::size_t frame = odd_frame(times, usual, kRoundedMs); frame > 0) {
      return MvnxClockFault{
          fmt::format("the times are not uniform: frame {} comes {:g} ms after the frame before, "
                      "not {:g} ms as usual; frames may be missing",
                      frame, times[frame] - times[frame - 1], usual),
          stamps[frame].line};
    }
  }
  const std::vector<double> indices = values_of(stamps, &MvnxStamp::index);
  if (!indices.empty()) {
    const double usual = median_step(indices);
    if (const std::size_t frame = odd_frame(indices, usual, 0.0); frame > 0) {
      return MvnxClockFault{
          fmt::format("the frame numbers are not uniform: frame {} has index {:g} after {:g}; "
                      "frames may be missing",
                      frame, indices[frame], indices[frame - 1]),
          stamps[frame].line};
    }
  }
  if (times.empty() || !fps) return std::nullopt;
  const double length = times.back() - times.front();
  const double expected = 1000.0 * static_cast<double>(times.size() - 1) / *fps;
  if (std::abs(length - expected) <= 2.0 * kRoundedMs + kSameMvnxRate * expected) {
    return std::nullopt;
  }
  const double found = 1000.0 * static_cast<double>(times.size() - 1) / length;
  return MvnxClockFault{
      fmt::format("the file states {:g} fps, but the times of its frames increase by {:.4g} ms, "
                  "which is {:.4g} fps",
                  *fps, 1000.0 / found, found),
      0};
}

}  // namespace retarget
