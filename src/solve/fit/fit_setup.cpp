#include "solve/fit/fit_setup.h"

#include <algorithm>
#include <array>
#include <vector>

#include "retarget/pose.h"
#include "solve/fit/shorthand.h"

namespace retarget {

PathScales path_scales(const TargetBuilder& targets) {
  HumanPose low, high, all;
  for (Pose& pose : all) pose.translation.z() = 1.0;
  int foot = targets.target_of(Bone::kLeftFootMod);
  // A model with one leg may have only a right foot.
  const Bone foot_bone = foot < 0 ? Bone::kRightFootMod : Bone::kLeftFootMod;
  foot = targets.target_of(foot_bone);
  std::vector<Pose> at_rest(at(targets.target_count())), raised = at_rest;
  targets.build(low, at_rest);
  targets.build(all, raised);
  const auto rise = [&](int target) {
    return (raised[at(target)].translation - at_rest[at(target)].translation).z();
  };
  // Raising all bones by one metre raises each target by the root's scale. Raising only the foot
  // bone raises its target by the foot's own scale.
  PathScales scales{rise(0), rise(0)};
  // A fixed base does not travel.
  if (foot >= 0 && !targets.base_is_held()) {
    high[foot_bone].translation.z() = 1.0;
    targets.build(high, raised);
    scales.foot = rise(foot);
  }
  return scales;
}

FitOptions options_for(const Robot& robot, FitOptions options) {
  if (!robot.fixed_base()) return options;
  options.contact = options.floor = options.foot_height = options.dynamics = false;
  return options;
}

LimitSet first_limits(const Robot& robot, const LimitSet& limits) {
  LimitSet result = limits;
  const auto own = load_limits(robot, robot.limits_for("gmr"));
  if (!own) return result;
  for (std::size_t i = 0; i < result.lower.size(); ++i) {
    const double lower = std::max(limits.lower[i], own->lower[i]);
    const double upper = std::min(limits.upper[i], own->upper[i]);
    if (lower > upper) continue;
    result.lower[i] = lower;
    result.upper[i] = upper;
  }
  return result;
}

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
       {&options.contact_weight, &options.contact_height_weight, &options.body_contact_weight,
        &options.body_contact_height_weight, &options.sole_floor_weight, &options.body_floor_weight,
        &options.self_collision_weight, &options.scene_contact_weight, &options.scene_place_weight,
        &options.scene_hold_weight}) {
    *weight *= std::max(size, 1.0);
  }
  return options;
}

FitOptions options_for_noise(FitOptions options, double noise) {
  constexpr double kLeast = 2.0 / 3.0;
  options.body_contact_weight *= 1.0 - (1.0 - kLeast) * noise;
  return options;
}

SourceSides sides_with_feet(const HumanClipInfo& info) {
  const auto has_foot = [&](Side side) {
    return std::ranges::all_of(
        std::array{LimbBone::kUpLeg, LimbBone::kLeg, LimbBone::kFoot, LimbBone::kToe},
        [&](LimbBone part) { return info.has(side_bone(side, part)); });
  };
  return {has_foot(Side::kLeft), has_foot(Side::kRight)};
}

}  // namespace retarget
