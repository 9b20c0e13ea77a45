#include "scene/key_rate.h"

#include <algorithm>
#include <cmath>

namespace retarget {
namespace {

constexpr double kMinRate = 12.0, kMaxRate = 1000.0;
constexpr std::size_t kMinKeys = 3;
// seconds: times are stored as floats, or in ticks
constexpr double kEqual = 2e-5;
// of a frame
constexpr double kMaxOff = 0.02;

}  // namespace

std::optional<double> rate_of_keys(std::vector<double> times) {
  std::erase_if(times, [](double time) { return !std::isfinite(time); });
  std::ranges::sort(times);
  const auto same = [](double a, double b) { return b - a < kEqual; };
  times.erase(std::unique(times.begin(), times.end(), same), times.end());
  if (times.size() < kMinKeys) return std::nullopt;
  double gap = times[1] - times[0];
  for (std::size_t i = 2; i < times.size(); ++i) gap = std::min(gap, times[i] - times[i - 1]);
  // from the first guess to the one that the whole length bears out
  const double length = times.back() - times.front();
  const double frames = std::round(length / gap);
  if (!(frames >= 1.0) || frames > 1e8) return std::nullopt;
  const double rate = frames / length;
  if (rate < kMinRate || rate > kMaxRate) return std::nullopt;
  for (const double time : times) {
    const double frame = (time - times.front()) * rate;
    if (std::abs(frame - std::round(frame)) > kMaxOff) return std::nullopt;
  }
  return rate;
}

}  // namespace retarget
