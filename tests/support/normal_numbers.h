#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace retarget {

/// Random numbers of standard deviation 1: sums of uniform numbers, which are equal with every
/// standard library.
class NormalNumbers {
 public:
  explicit NormalNumbers(std::uint32_t seed) : random_(seed) {}

  double next() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random_()) / 4294967296.0;
    return sum;
  }
  Eigen::Vector3d next_vector() {
    const double x = next(), y = next(), z = next();
    return {x, y, z};
  }

 private:
  std::mt19937 random_;
};

}  // namespace retarget
