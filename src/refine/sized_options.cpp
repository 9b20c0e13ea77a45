#include "refine/sized_options.h"

#include <algorithm>

namespace retarget {
namespace {

constexpr double kUsualLeg = 0.632;  // metres

}  // namespace

FitOptions sized_options(FitOptions options, double leg) {
  const double size = kUsualLeg / leg;
  TrackingWeights& w = options.weights;
  for (double* weight :
       {&w.hips_position, &w.thigh_position, &w.shank_position, &w.foot_position,
        &w.upper_arm_position, &w.forearm_position, &w.hand_position, &w.other_position,
        &options.foot_height_near, &options.foot_height_far, &options.smoothness_root_position}) {
    *weight *= size;
  }
  for (double* weight :
       {&options.contact_weight, &options.contact_height_weight, &options.sole_floor_weight,
        &options.body_floor_weight, &options.self_collision_weight}) {
    *weight *= std::max(size, 1.0);
  }
  return options;
}

}  // namespace retarget
