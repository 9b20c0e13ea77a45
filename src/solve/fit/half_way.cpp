#include "solve/fit/half_way.h"

#include <Eigen/Core>

#include "retarget/shape_distance.h"
#include "solve/fit/shorthand.h"

namespace retarget {

HalfWay::HalfWay(const FitModel& model)
    : model_(model), pose_(model.tree), qpos_(at(model.configuration_size)) {}

void HalfWay::update(std::span<const double> from, std::span<const double> to) {
  // The sign of a quaternion is arbitrary.
  double cosine = 0.0;
  for (std::size_t k = 3; k < 7; ++k) cosine += from[k] * to[k];
  const double sign = cosine < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < qpos_.size(); ++i) {
    qpos_[i] = 0.5 * ((i >= 3 && i < 7 ? sign : 1.0) * from[i] + to[i]);
  }
  pose_.update(qpos_);
}

double HalfWay::distance(std::uint32_t pair) const {
  const auto in_world = [&](int shape) {
    const FitShape& own = model_.shapes[at(shape)];
    return placed(own, pose_.world_from_link[at(own.link)]);
  };
  const FitPair& shapes = model_.pairs[pair];
  return shape_distance(in_world(shapes.a), in_world(shapes.b), NearestPoints::kEven).distance;
}

bool may_cross(const FitModel& model, const TreeState& before, const TreeState& now,
               std::uint32_t pair) {
  constexpr double kPassing = 0.06;  // Metres.
  const auto step = [&](int shape) -> Eigen::Vector3d {
    const FitShape& own = model.shapes[at(shape)];
    const auto link = at(own.link);
    return now.world_from_link[link] * own.centre - before.world_from_link[link] * own.centre;
  };
  const FitPair& shapes = model.pairs[pair];
  return (step(shapes.a) - step(shapes.b)).squaredNorm() > square(kPassing);
}

}  // namespace retarget
