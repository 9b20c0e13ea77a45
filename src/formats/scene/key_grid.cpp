#include "formats/scene/key_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace retarget {
namespace {

constexpr std::size_t kMinGridKeys = 3;
constexpr double kMostGridFrames = 1e8;
// Seconds; files store times as floats or in ticks.
constexpr double kEqualTimes = 2e-5;
// Spacing of single-precision numbers, relative to the number.
constexpr double kFloatSpacing = 1.2e-7;
// Deviation of a key from its frame that is always tolerated, in frames.
constexpr double kMaxAway = 0.02;
// Limit on the tolerance for rounded times, in frames. Coarser times define no frames.
constexpr double kMaxRoundedAway = 0.26;

// Rounded times of the rates below differ from them by less than one unit. Times that differ by one
// unit are uneven.
constexpr double kMaxUnits = 0.992;

// Relative error of a sum of frame times.
constexpr double kMaxDrift = 1e-3;

// Usual rates, the most usual first: rounded times of short clips may fit several.
constexpr std::array<FrameRate, 18> kGridRates = {{{30, 1},
                                                   {60, 1},
                                                   {24, 1},
                                                   {25, 1},
                                                   {120, 1},
                                                   {50, 1},
                                                   {100, 1},
                                                   {240, 1},
                                                   {15, 1},
                                                   {48, 1},
                                                   {72, 1},
                                                   {144, 1},
                                                   {90, 1},
                                                   {200, 1},
                                                   {24000, 1001},
                                                   {30000, 1001},
                                                   {60000, 1001},
                                                   {120000, 1001}}};

double largest_time(const std::vector<double>& times) {
  return std::max(std::abs(times.front()), std::abs(times.back()));
}

// The largest difference between the rounding errors of two of these ascending times, seconds. Some
// exporters write milliseconds.
double rounding_of(const std::vector<double>& times) {
  const double spacing = kFloatSpacing * largest_time(times);
  for (const double unit : {1e-3, 1e-4, 1e-5}) {
    // In single precision, times far from zero are multiples of any fine unit.
    const double fits = 0.5 * spacing + 1e-9;
    if (fits > 0.1 * unit) break;
    if (std::ranges::all_of(times, [&](double time) {
          return std::abs(time - unit * std::round(time / unit)) <= fits;
        })) {
      return kMaxUnits * unit + spacing;
    }
  }
  return 2.0 * spacing;
}

// Frames of keys, and whether the keys lie at them without any tolerance for rounded times.
struct NumberedKeys {
  std::vector<std::int64_t> frames;
  bool is_exact = false;
};

// Numbers the frames of keys at a rate. Nothing if a key lies between frames.
std::optional<NumberedKeys> numbered_keys(const std::vector<double>& times, double rate,
                                          double rounding) {
  const double most = std::min(rounding * rate, kMaxRoundedAway);
  std::vector<std::int64_t> frames = {0};
  double lowest = 0.0, highest = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double frame = (times[i] - times.front()) * rate;
    if (!(frame < kMostGridFrames)) return std::nullopt;
    const double whole = std::round(frame);
    lowest = std::min(lowest, frame - whole);
    highest = std::max(highest, frame - whole);
    frames.push_back(static_cast<std::int64_t>(whole));
    // Two keys of one frame are not evenly spaced.
    if (frames[i] == frames[i - 1]) return std::nullopt;
  }
  const bool is_exact = std::max(-lowest, highest) <= kMaxAway;
  if (!is_exact && highest - lowest > most) return std::nullopt;
  return NumberedKeys{std::move(frames), is_exact};
}

// Numbers the frames of keys whose times drift, as those of programs that add up frame times in
// single precision. Nothing if two keys are not a whole number of frames apart.
std::optional<std::vector<std::int64_t>> numbered_by_gaps(const std::vector<double>& times,
                                                          double rate) {
  std::vector<std::int64_t> frames = {0};
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double gap = (times[i] - times[i - 1]) * rate;
    const double whole = std::round(gap);
    if (!(whole >= 1.0 && whole < kMostGridFrames)) return std::nullopt;
    if (std::abs(gap - whole) > 2.0 * kMaxAway + kMaxDrift * whole) return std::nullopt;
    frames.push_back(frames.back() + static_cast<std::int64_t>(whole));
  }
  return frames;
}

// The usual rate that differs by drift alone.
FrameRate drifting_rate(double fps) {
  for (const FrameRate& usual : kGridRates) {
    if (std::abs(fps / usual.fps() - 1.0) <= kMaxDrift) return usual;
  }
  return frame_rate_from_fps(fps);
}

// The mean gap between frames. Small gaps tell how many frames are in the larger ones.
double mean_gap(std::vector<double> gaps) {
  std::ranges::sort(gaps);
  double length = 0.0, frames = 0.0;
  for (const double gap : gaps) {
    frames += frames == 0.0 ? 1.0 : std::max(1.0, std::round(gap * frames / length));
    length += gap;
  }
  return length / frames;
}

// Rates at which the keys may be frames, the most accurate first.
std::vector<double> possible_rates(const std::vector<double>& times, double rounding) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < times.size(); ++i) gaps.push_back(times[i] - times[i - 1]);
  const double smallest = *std::ranges::min_element(gaps);
  const double length = times.back() - times.front();
  const auto refined = [length](double gap) { return std::round(length / gap) / length; };
  std::vector<double> rates = {refined(smallest), refined(mean_gap(std::move(gaps)))};
  // If keys are few and their times are rounded, the mean gap may be too inaccurate.
  for (const FrameRate& usual : kGridRates) {
    if (std::abs(usual.frame_time() - smallest) <= rounding) rates.push_back(usual.fps());
  }
  return rates;
}

// The usual rate that explains the times of keys within their rounding.
std::optional<FrameRate> usual_rate_of(const std::vector<double>& times, std::int64_t frames,
                                       double rounding) {
  const double length = times.back() - times.front();
  for (const FrameRate& usual : kGridRates) {
    if (std::abs(usual.time_of(frames) - length) <= rounding) return usual;
  }
  return std::nullopt;
}

}  // namespace

double KeyGrid::time_of(std::int64_t frame) const {
  const auto next = std::ranges::lower_bound(frames, frame);
  const auto at = static_cast<std::size_t>(next - frames.begin());
  if (next != frames.end() && *next == frame) return times[at];
  if (next == frames.end()) return times.back() + rate.time_of(frame - frames.back());
  if (at == 0) return times.front() + rate.time_of(frame - frames.front());
  const double share = static_cast<double>(frame - frames[at - 1]) /
                       static_cast<double>(frames[at] - frames[at - 1]);
  return times[at - 1] + share * (times[at] - times[at - 1]);
}

std::vector<double> distinct_times(std::vector<double> times) {
  std::erase_if(times, [](double time) { return !std::isfinite(time); });
  std::ranges::sort(times);
  if (times.empty()) return times;
  const double equal = std::max(kEqualTimes, kFloatSpacing * largest_time(times));
  // The last of equal times is kept, because steps happen at or before it.
  std::vector<double> distinct;
  double first = times.front();
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (i + 1 < times.size() && times[i + 1] - first < equal) continue;
    distinct.push_back(times[i]);
    if (i + 1 < times.size()) first = times[i + 1];
  }
  return distinct;
}

std::optional<KeyGrid> grid_of_keys(std::vector<double> times) {
  times = distinct_times(std::move(times));
  if (times.size() < kMinGridKeys) return std::nullopt;
  const double rounding = rounding_of(times);
  const double length = times.back() - times.front();
  const std::vector<double> rates = possible_rates(times, rounding);
  for (const double rate : rates) {
    if (!(rate > 0.0)) continue;
    auto keys = numbered_keys(times, rate, rounding);
    if (!keys) continue;
    const std::int64_t last = keys->frames.back();
    const auto usual = usual_rate_of(times, last, rounding);
    // Some unusual rate fits almost any rounded times.
    if (!keys->is_exact && !usual) continue;
    KeyGrid grid;
    grid.fps = static_cast<double>(last) / length;
    grid.rate = usual ? *usual : frame_rate_from_fps(grid.fps);
    grid.times = std::move(times);
    grid.frames = std::move(keys->frames);
    return grid;
  }
  for (const double rate : rates) {
    auto frames = rate > 0.0 ? numbered_by_gaps(times, rate) : std::nullopt;
    if (!frames) continue;
    KeyGrid grid;
    grid.fps = static_cast<double>(frames->back()) / length;
    if (std::abs(grid.fps / rate - 1.0) > kMaxDrift) continue;
    grid.rate = drifting_rate(grid.fps);
    grid.times = std::move(times);
    grid.frames = *std::move(frames);
    return grid;
  }
  return std::nullopt;
}

}  // namespace retarget
