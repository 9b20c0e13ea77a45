#include "human/find_rest.h"

#include <string>
#include <utility>

#include "base/option_name.h"
#include "human/body_axes.h"
#include "human/learned_axes.h"

namespace retarget {
namespace {

// a frame within these is a T-pose that was meant as one
constexpr double kExactMean = 5.0;      // degrees
constexpr double kExactLargest = 12.0;  // degrees

std::optional<RestCandidate> candidate(const RestSearch& search, JointPoses pose,
                                       const Eigen::Vector3d& up) {
  const auto& [clip, map, options, body, movement] = search;
  std::optional<BodyFromFile> axes;
  if (!options.forward) {
    axes = body_axes(body, pose, up);
  } else if (up.cross(options.forward->direction()).norm() > 0.5) {
    axes = told_axes(options.forward->direction(), up);
  }
  if (!axes) return std::nullopt;
  return RestCandidate{std::move(pose), *axes};
}

Result<Rest> taken(const RestSearch& search, std::optional<RestCandidate> found, std::string name) {
  if (!found) {
    return input_failure(
        {}, "the " + name + " has no facing direction: hips and shoulders lie along the up axis",
        "choose another rest pose, or give " OPTION("forward"));
  }
  JointFromBone axes = bring_to_t(search.body, *found);
  return Rest{*std::move(found), std::move(axes), std::move(name)};
}

Result<Rest> rest_of_tpose_file(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  const Skeleton& own = clip.skeleton();
  const Clip& tpose = *options.tpose;
  const JointPoses given =
      tpose.frame_count() > 0 ? frame_pose(tpose, 0) : zero_pose(tpose.skeleton());
  // only the mapped joints and the ends of their bones are looked at
  JointPoses pose = zero_pose(own);
  for (int joint = 0; joint < own.joint_count(); ++joint) {
    const auto same = tpose.skeleton().find(own.joint(joint).name);
    if (same) pose[joint] = given[*same];
    if (!same && map.maps(joint)) {
      return input_failure({}, "the T-pose file has no joint \"" + own.joint(joint).name + "\"",
                           "give a T-pose of the same skeleton");
    }
  }
  const auto trunk = trunk_direction(body, pose);
  if (!trunk) return taken(search, std::nullopt, "T-pose file");
  return taken(search, candidate(search, std::move(pose), nearest_axis(*trunk).direction()),
               "T-pose file");
}

Result<Rest> rest_of_movement(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  const auto best = best_frame(search);
  if (!best || movement.poses.empty()) return taken(search, std::nullopt, "movement");
  return Rest{best->second,
              learned_axes(body, movement.poses, movement.up.direction(), best->second), "learned"};
}

Result<Rest> told_rest(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  if (options.rest == RestPose::kZero) return taken(search, zero_candidate(search), "zero pose");
  if (clip.frame_count() == 0) return input_failure({}, "no frames: there is no rest pose");
  if (options.rest == RestPose::kLearned) return rest_of_movement(search);
  if (options.rest == RestPose::kBest) {
    const auto best = best_frame(search);
    if (!best) return taken(search, std::nullopt, "movement");
    return taken(search, best->second, "frame " + std::to_string(best->first));
  }
  const int frame = options.rest == RestPose::kFirst ? 0 : options.rest_frame;
  if (frame < 0 || frame >= clip.frame_count()) {
    return usage_failure("no frame " + std::to_string(frame) + ": the clip has " +
                         std::to_string(clip.frame_count()));
  }
  return taken(search, candidate(search, frame_pose(clip, frame), movement.up.direction()),
               "frame " + std::to_string(frame));
}

// the rest pose of a kind of skeleton, when it is one in this file
std::optional<Rest> rest_of_profile(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  constexpr double kMaxOff = 20.0;  // degrees
  const bool is_zero = map.facts.rest == RestPose::kZero;
  std::optional<RestCandidate> pose;
  if (is_zero) pose = zero_candidate(search);
  if (map.facts.rest == RestPose::kFirst && clip.frame_count() > 0) {
    pose = candidate(search, frame_pose(clip, 0), movement.up.direction());
  }
  if (!pose || deviation_from_t(body, *pose).mean > kMaxOff) return std::nullopt;
  auto rest = taken(search, std::move(pose), is_zero ? "zero pose" : "frame 0");
  return rest ? std::optional<Rest>(*std::move(rest)) : std::nullopt;
}

// one pose says little of how arms are turned about themselves
Result<Rest> with_arms_of_movement(const RestSearch& search, Result<Rest> rest) {
  const auto& [clip, map, options, body, movement] = search;
  if (rest && !movement.poses.empty()) {
    rest->axes = with_corrected_arms(body, movement.poses, movement.up.direction(), rest->axes);
  }
  return rest;
}

}  // namespace

// a zero pose is built along its own axes, which need not be those of the movement
std::optional<RestCandidate> zero_candidate(const RestSearch& search) {
  JointPoses pose = zero_pose(search.body.skeleton());
  const auto trunk = trunk_direction(search.body, pose);
  if (!trunk) return std::nullopt;
  auto found = candidate(search, std::move(pose), nearest_axis(*trunk).direction());
  if (found) found->is_built = true;
  return found;
}

std::optional<std::pair<int, RestCandidate>> best_frame(const RestSearch& search) {
  const Movement& movement = search.movement;
  std::optional<std::pair<int, RestCandidate>> best;
  double min = 0.0;
  const auto consider = [&](int frame, const JointPoses& pose) {
    auto found = candidate(search, pose, movement.up.direction());
    if (!found) return;
    const double mean = deviation_from_t(search.body, *found).mean;
    // poses that are equal but for rounding count as one, the first
    if (best && mean > min - 1e-6) return;
    min = mean;
    best = std::pair(frame, *std::move(found));
  };
  // a T-pose in front is none of the motion, but a rest pose
  for (int frame = 0; frame < movement.lead_in; ++frame)
    consider(frame, frame_pose(search.clip, frame));
  for (std::size_t i = 0; i < movement.poses.size(); ++i)
    consider(movement.frames[i], movement.poses[i]);
  return best;
}

Result<Rest> find_rest(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  if (options.tpose) return rest_of_tpose_file(search);
  if (options.rest != RestPose::kAuto) return told_rest(search);
  if (auto known = rest_of_profile(search)) return *std::move(known);
  if (map.facts.rest == RestPose::kLearned) return rest_of_movement(search);
  const auto zero = zero_candidate(search);
  if (zero && is_well_formed(body, *zero)) {
    return with_arms_of_movement(search, taken(search, zero, "zero pose"));
  }
  if (const auto best = best_frame(search)) {
    const Deviation deviation = deviation_from_t(body, best->second);
    if (deviation.mean < kExactMean && deviation.largest < kExactLargest) {
      return with_arms_of_movement(
          search, taken(search, best->second, "frame " + std::to_string(best->first)));
    }
  }
  return rest_of_movement(search);
}

}  // namespace retarget
