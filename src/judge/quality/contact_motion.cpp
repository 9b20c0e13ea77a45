#include "judge/quality/contact_motion.h"

#include <algorithm>
#include <cmath>

#include "retarget/statistics.h"

namespace retarget {
namespace {

constexpr double kSlipping = 0.1;  // m/s

double distance(double x, double y) {
  return std::sqrt(x * x + y * y);
}

}  // namespace

void ContactMotion::add(const std::vector<Eigen::Vector3d>& places, int begin, double fps,
                        const std::string& name, FaultList& slipping) {
  const auto stride = static_cast<std::size_t>(difference_stride(fps));
  std::vector<double> x, y;
  for (const Eigen::Vector3d& place : places) {
    const std::size_t i = x.size();
    x.push_back(place.x());
    y.push_back(place.y());
    if (i < stride) continue;
    const double slip =
        distance(x[i] - x[i - stride], y[i] - y[i - stride]) * (fps / static_cast<double>(stride));
    slips.push_back(slip);
    if (slip > kSlipping) slipping.add(name, begin + static_cast<int>(i - stride), slip);
  }
  const double x0 = median(x), y0 = median(y);
  double drift = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    drift = std::max(drift, distance(x[i] - x0, y[i] - y0));
  }
  drifts.push_back(drift);
}

}  // namespace retarget
