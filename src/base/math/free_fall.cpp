#include "base/math/free_fall.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace retarget {

using Eigen::Vector3d;

Parabola fit_parabola(std::span<const Vector3d> places, double step) {
  const int half = static_cast<int>(places.size() / 2);
  const auto place = [&](int k) { return places[static_cast<std::size_t>(half + k)]; };
  double square = 0.0, fourth = 0.0;
  std::array<Vector3d, 3> moments{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  for (int k = -half; k <= half; ++k) {
    const double t = k * step;
    square += t * t;
    fourth += t * t * t * t;
    moments[0] += place(k);
    moments[1] += t * place(k);
    moments[2] += t * t * place(k);
  }
  const double count = 2.0 * half + 1.0, determinant = count * fourth - square * square;
  const Vector3d start = (fourth * moments[0] - square * moments[2]) / determinant;
  const Vector3d speed = moments[1] / square;
  const Vector3d curve = (count * moments[2] - square * moments[0]) / determinant;
  double sum = 0.0;
  for (int k = -half; k <= half; ++k) {
    const double t = k * step;
    sum += (place(k) - start - speed * t - curve * t * t).squaredNorm();
  }
  return {2.0 * curve, std::sqrt(sum / count)};
}

int free_fall_reach(double step) {
  constexpr double kHalf = 0.1;       // Seconds.
  constexpr double kTolerance = 0.1;  // Samples.
  const int reach = static_cast<int>(std::ceil(kHalf / step - kTolerance));
  return reach < 2 ? 0 : reach;
}

}  // namespace retarget
