#include "solve/fit/half_way.h"

#include <Eigen/Core>

#include "retarget/shape_distance.h"
#include "robot/model/half_way.h"
#include "solve/fit/shorthand.h"

namespace retarget {

double pair_distance(const FitModel& model, const TreeState& pose, std::uint32_t pair) {
  const auto in_world = [&](int shape) {
    const FitShape& own = model.shapes[at(shape)];
    return placed(own, pose.world_from_link[at(own.link)]);
  };
  const FitPair& shapes = model.pairs[pair];
  return shape_distance(in_world(shapes.a), in_world(shapes.b), NearestPoints::kEven).distance;
}

bool may_cross(const FitModel& model, const TreeState& before, const TreeState& now,
               std::uint32_t pair) {
  const auto step = [&](int shape) -> Eigen::Vector3d {
    const FitShape& own = model.shapes[at(shape)];
    const auto link = at(own.link);
    return now.world_from_link[link] * own.centre - before.world_from_link[link] * own.centre;
  };
  const FitPair& shapes = model.pairs[pair];
  return (step(shapes.a) - step(shapes.b)).squaredNorm() > square(kPassing);
}

HalfWay::HalfWay(const FitModel& model) : pose_(model.tree), qpos_(at(model.configuration_size)) {}

void HalfWay::update(std::span<const double> from, std::span<const double> to) {
  half_way_between(from, to, qpos_);
  pose_.update(qpos_);
}

}  // namespace retarget
