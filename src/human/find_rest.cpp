#include "human/find_rest.h"

#include <algorithm>
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

}  // namespace

std::optional<RestCandidate> RestFinder::candidate(JointPoses pose,
                                                   const Eigen::Vector3d& up) const {
  std::optional<BodyFromFile> axes;
  if (!options_.forward) {
    axes = body_axes(body_, pose, up);
  } else if (up.cross(options_.forward->direction()).norm() > 0.5) {
    axes = told_axes(options_.forward->direction(), up);
  }
  if (!axes) return std::nullopt;
  return RestCandidate{std::move(pose), *axes};
}

// a zero pose is built along its own axes, which need not be those of the movement
std::optional<RestCandidate> RestFinder::zero_candidate() const {
  JointPoses pose = zero_pose(body_.skeleton());
  const auto trunk = trunk_direction(body_, pose);
  if (!trunk) return std::nullopt;
  auto found = candidate(std::move(pose), nearest_axis(*trunk).direction());
  if (found) found->is_built = true;
  return found;
}

std::optional<std::pair<int, RestCandidate>> RestFinder::best_frame() const {
  std::optional<std::pair<int, RestCandidate>> best;
  double least = 0.0;
  const auto consider = [&](int frame, const JointPoses& pose) {
    auto found = candidate(pose, movement_.up.direction());
    if (!found) return;
    const double mean = deviation_from_t(body_, *found).mean;
    // poses that are equal but for rounding count as one, the first
    if (best && mean > least - 1e-6) return;
    least = mean;
    best = std::pair(frame, *std::move(found));
  };
  // a T-pose in front is none of the motion, but a rest pose
  for (int frame = 0; frame < movement_.lead_in; ++frame) consider(frame, frame_pose(clip_, frame));
  for (std::size_t i = 0; i < movement_.poses.size(); ++i)
    consider(movement_.frames[i], movement_.poses[i]);
  return best;
}

Result<Rest> RestFinder::taken(std::optional<RestCandidate> found, std::string name) const {
  if (!found) {
    return input_failure(file_, "the " + name + " shows no facing: hips and shoulders lie along up",
                         "choose another rest pose, or give " OPTION("forward"));
  }
  JointFromBone axes = bring_to_t(body_, *found);
  return Rest{*std::move(found), std::move(axes), std::move(name)};
}

Result<Rest> RestFinder::rest_of_tpose_file() const {
  const Skeleton& own = clip_.skeleton();
  const Clip& tpose = *options_.tpose;
  const JointPoses given =
      tpose.frame_count() > 0 ? frame_pose(tpose, 0) : zero_pose(tpose.skeleton());
  // only the mapped joints and the ends of their bones are looked at
  JointPoses pose = zero_pose(own);
  for (int joint = 0; joint < own.joint_count(); ++joint) {
    const auto same = tpose.skeleton().find(own.joint(joint).name);
    if (same) pose[joint] = given[*same];
    if (!same && std::ranges::count(map_.joint_of_bone, joint) > 0) {
      return input_failure(file_, "the T-pose file has no joint \"" + own.joint(joint).name + "\"",
                           "give a T-pose of the same skeleton");
    }
  }
  const auto trunk = trunk_direction(body_, pose);
  if (!trunk) return taken(std::nullopt, "T-pose file");
  return taken(candidate(std::move(pose), nearest_axis(*trunk).direction()), "T-pose file");
}

Result<Rest> RestFinder::told_rest() const {
  if (options_.rest == RestPose::kZero) return taken(zero_candidate(), "zero pose");
  if (clip_.frame_count() == 0) return input_failure(file_, "no frames: no frame is a rest pose");
  if (options_.rest == RestPose::kLearned) return rest_of_movement();
  if (options_.rest == RestPose::kBest) {
    const auto best = best_frame();
    if (!best) return taken(std::nullopt, "movement");
    return taken(best->second, "frame " + std::to_string(best->first));
  }
  const int frame = options_.rest == RestPose::kFirst ? 0 : options_.rest_frame;
  if (frame < 0 || frame >= clip_.frame_count()) {
    return usage_failure("no frame " + std::to_string(frame) + ": the clip has " +
                         std::to_string(clip_.frame_count()));
  }
  return taken(candidate(frame_pose(clip_, frame), movement_.up.direction()),
               "frame " + std::to_string(frame));
}

// the rest pose of a kind of skeleton, when it is one in this file
std::optional<Rest> RestFinder::rest_of_dialect() const {
  constexpr double kMostOff = 20.0;  // degrees
  const std::string& known = map_.facts.rest_pose;
  std::optional<RestCandidate> pose;
  if (known == "zero") pose = zero_candidate();
  if (known == "first" && clip_.frame_count() > 0) {
    pose = candidate(frame_pose(clip_, 0), movement_.up.direction());
  }
  if (!pose || deviation_from_t(body_, *pose).mean > kMostOff) return std::nullopt;
  auto rest = taken(std::move(pose), known == "zero" ? "zero pose" : "frame 0");
  return rest ? std::optional<Rest>(*std::move(rest)) : std::nullopt;
}

// one pose says little of how arms are turned about themselves
Result<Rest> RestFinder::with_arms_of_movement(Result<Rest> rest) const {
  if (rest && !movement_.poses.empty()) {
    rest->axes = with_corrected_arms(body_, movement_.poses, movement_.up.direction(), rest->axes);
  }
  return rest;
}

Result<Rest> RestFinder::find() const {
  if (options_.tpose) return rest_of_tpose_file();
  if (options_.rest != RestPose::kAuto) return told_rest();
  if (auto known = rest_of_dialect()) return *std::move(known);
  if (map_.facts.rest_pose == "learned") return rest_of_movement();
  const auto zero = zero_candidate();
  if (zero && is_well_formed(body_, *zero)) {
    return with_arms_of_movement(taken(zero, "zero pose"));
  }
  if (const auto best = best_frame()) {
    const Deviation deviation = deviation_from_t(body_, best->second);
    if (deviation.mean < kExactMean && deviation.largest < kExactLargest) {
      return with_arms_of_movement(taken(best->second, "frame " + std::to_string(best->first)));
    }
  }
  return rest_of_movement();
}

Result<Rest> RestFinder::rest_of_movement() const {
  const auto best = best_frame();
  if (!best || movement_.poses.empty()) return taken(std::nullopt, "movement");
  return Rest{best->second,
              learned_axes(body_, movement_.poses, movement_.up.direction(), best->second),
              "learned"};
}

}  // namespace retarget
