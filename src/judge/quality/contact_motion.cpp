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
  std::vector<double> x, y;
  for (const Eigen::Vector3d& place : places) {
    if (!x.empty()) {
      const double slip = distance(place.x() - x.back(), place.y() - y.back()) * fps;
      slips.push_back(slip);
      const int frame = begin + static_cast<int>(x.size());
      if (slip > kSlipping) slipping.add(name, frame - 1, slip);
    }
    x.push_back(place.x());
    y.push_back(place.y());
  }
  const double x0 = median(x), y0 = median(y);
  double drift = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    drift = std::max(drift, distance(x[i] - x0, y[i] - y0));
  }
  drifts.push_back(drift);
}

}  // namespace retarget
