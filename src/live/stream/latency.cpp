#include "live/stream/latency.h"

#include <algorithm>

namespace retarget {
namespace {

constexpr double kFirst = 1e-6;  // seconds
constexpr double kGrowth = 1.05;

}  // namespace

void Latency::add(double seconds) {
  std::size_t size = 0;
  for (double bound = kFirst; bound < seconds && size + 1 < counts_.size(); bound *= kGrowth) {
    ++size;
  }
  ++counts_[size];
  ++count_;
  max_ = std::max(max_, seconds);
}

double Latency::percentile(double percent) const {
  const double wanted = 0.01 * percent * static_cast<double>(count_);
  double bound = kFirst;
  std::int64_t below = 0;
  for (const std::int64_t count : counts_) {
    below += count;
    if (below > 0 && static_cast<double>(below) >= wanted) return std::min(bound, max_);
    bound *= kGrowth;
  }
  return max_;
}

}  // namespace retarget
