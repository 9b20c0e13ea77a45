#include "robot/model/half_way.h"

#include <Eigen/Core>
#include <cstddef>

#include "retarget/so3.h"

namespace retarget {

void half_way_between(std::span<const double> from, std::span<const double> to,
                      std::span<double> half_way) {
  for (std::size_t i = 0; i < half_way.size(); ++i) half_way[i] = 0.5 * (from[i] + to[i]);
  const Eigen::Vector4d end = Eigen::Map<const Eigen::Vector4d>(to.data() + 3);
  Eigen::Vector4d begin = Eigen::Map<const Eigen::Vector4d>(from.data() + 3);
  align_sign(end, begin);
  Eigen::Map<Eigen::Vector4d>(half_way.data() + 3) = (begin + end).normalized();
}

}  // namespace retarget
