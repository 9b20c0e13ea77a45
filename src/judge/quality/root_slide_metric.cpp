#include "judge/quality/root_slide_metric.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace retarget {

std::optional<double> root_slide(const std::vector<Eigen::Vector3d>& found,
                                 const std::vector<Eigen::Vector3d>& wanted, double fps) {
  constexpr double kTime = 2.0;  // seconds
  const std::size_t frames = std::min(found.size(), wanted.size());
  if (frames < 2) return std::nullopt;
  const auto step =
      std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(kTime * fps)), 1, frames - 1);
  double sum = 0.0;
  for (std::size_t i = 0; i + step < frames; ++i) {
    const Eigen::Vector3d left = (found[i + step] - wanted[i + step]) - (found[i] - wanted[i]);
    sum += left.head<2>().norm();
  }
  return sum / static_cast<double>(frames - step) * fps / static_cast<double>(step);
}

}  // namespace retarget
