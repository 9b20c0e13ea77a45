#include "human/skeleton/find_rest.h"

#include <fmt/format.h>
#include <cmath>
#include <cstddef>

#include "base/option_name.h"
#include "human/skeleton/expected_error.h"

namespace retarget {
namespace {

// A frame within these deviations is an intended T-pose.
constexpr double kExactMean = 5.0;      // degrees
constexpr double kExactLargest = 12.0;  // degrees

// A pose replaces the learned axes only if its expected error is smaller by this lead.
constexpr double kClearLead = 3.0;  // degrees

// A frame that may be an inexact T-pose or A-pose is a candidate only if the movement has a larger
// expected error.
constexpr double kShowsLittle = 10.0;  // degrees

// Minimum number of sampled poses that doubts about a rest pose need.
constexpr std::size_t kMinPosesToCompare = 5;

constexpr const char* kLearnedName = "learned";

std::optional<RestCandidate> candidate(const RestSearch& search, JointPoses pose,
                                       const Eigen::Vector3d& up) {
  const auto& [clip, map, options, body, movement] = search;
  std::optional<BodyFromFile> axes;
  if (!options.forward) {
    axes = body_axes(body, pose, up);
  } else if (up.cross(options.forward->direction()).norm() > 0.5) {
    axes = given_axes(options.forward->direction(), up);
  }
  if (!axes) return std::nullopt;
  return RestCandidate{std::move(pose), *axes};
}

// The axes of a pose. Whether its soles are square to the shins or on a floor is a convention that
// the pose does not show (RestCandidate::is_built); the feet that stand in the movement do.
JointFromBone axes_in(const RestSearch& search, RestCandidate& found) {
  const Movement& movement = search.movement;
  JointFromBone axes = bring_to_t(search.body, found);
  const SoleCheck soles(search.body, movement.poses, movement.up.direction());
  RestCandidate other = found;
  other.is_built = !found.is_built;
  JointFromBone others = bring_to_t(search.body, other);
  const auto error = soles.error(axes), error_of_other = soles.error(others);
  if (error && error_of_other && *error_of_other + kClearLead < *error) {
    found = std::move(other);
    axes = std::move(others);
  }
  return soles.corrected(found, std::move(axes));
}

Result<Rest> taken(const RestSearch& search, std::optional<RestCandidate> found, std::string name) {
  if (!found) {
    return input_failure(
        {}, "the " + name + " has no facing direction: hips and shoulders lie along the up axis",
        "choose another rest pose, or give " OPTION("forward"));
  }
  JointFromBone axes = axes_in(search, *found);
  return Rest{*std::move(found), std::move(axes), std::move(name), {}, {}};
}

Result<Rest> rest_of_tpose_file(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  const Skeleton& own = clip.skeleton();
  const Clip& tpose = *options.tpose;
  const JointPoses given =
      tpose.frame_count() > 0 ? frame_pose(tpose, 0) : zero_pose(tpose.skeleton());
  // Only the mapped joints and the ends of their bones matter.
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

// Finds a frame to start learning from. If no frame has a facing along the up axis, uses one that
// has a facing along its own trunk.
std::optional<RestCandidate> start_of_learning(const RestSearch& search) {
  if (auto best = best_frame(search)) return std::move(best->second);
  for (const JointPoses& pose : search.movement.poses) {
    const auto trunk = trunk_direction(search.body, pose);
    if (!trunk) continue;
    if (auto found = candidate(search, pose, *trunk)) return found;
  }
  return std::nullopt;
}

Result<Rest> rest_of_movement(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  auto start = start_of_learning(search);
  if (!start || movement.poses.empty()) return taken(search, std::nullopt, "movement");
  LearnedAxes learned = learned_axes(body, movement.poses, movement.up.direction(), *start);
  return Rest{*std::move(start), std::move(learned.axes), kLearnedName, {}, {}};
}

Result<Rest> given_rest(const RestSearch& search) {
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

// Returns the rest pose of the profile, if it is close to a T-pose in this file.
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

// A single pose hardly determines the roll of the arms, and rotations that were made for another
// skeleton bend the knees about another axis than the pose has.
Result<Rest> with_limbs_of_movement(const RestSearch& search, Result<Rest> rest) {
  const auto& [clip, map, options, body, movement] = search;
  if (rest && !movement.poses.empty()) {
    const Eigen::Vector3d up = movement.up.direction();
    rest->axes = with_corrected_arms(body, movement.poses, up, rest->axes);
    rest->axes = with_corrected_legs(body, movement.poses, up, rest->axes);
  }
  return rest;
}

// A pose that its maker or the performer intended as a rest pose takes precedence over the movement.
std::optional<Rest> meant_rest(const RestSearch& search) {
  const auto& [clip, map, options, body, movement] = search;
  if (auto known = rest_of_profile(search)) {
    if (!movement.poses.empty()) {
      known->axes = with_corrected_legs(body, movement.poses, movement.up.direction(), known->axes);
    }
    return known;
  }
  if (map.facts.rest == RestPose::kLearned) return std::nullopt;
  const auto kept = [&](RestCandidate found, std::string name) {
    auto rest = with_limbs_of_movement(search, taken(search, std::move(found), std::move(name)));
    return rest ? std::optional<Rest>(*std::move(rest)) : std::nullopt;
  };
  const auto zero = zero_candidate(search);
  if (zero && is_well_formed(body, *zero)) return kept(*zero, "zero pose");
  const auto best = best_frame(search);
  if (!best) return std::nullopt;
  const Deviation deviation = deviation_from_t(body, best->second);
  if (deviation.mean >= kExactMean || deviation.largest >= kExactLargest) return std::nullopt;
  return kept(best->second, "frame " + std::to_string(best->first));
}

// A rest pose with the expected error of its axes.
struct ScoredRest {
  Rest rest;
  double error = 0.0;  // degrees
};

// All candidates; the axes that are learned from the movement come last.
std::vector<ScoredRest> scored_rests(const RestSearch& search, const std::optional<Rest>& meant) {
  const auto& [clip, map, options, body, movement] = search;
  std::vector<ScoredRest> scored;
  auto start = start_of_learning(search);
  if (!start || movement.poses.empty()) return scored;
  LearnedAxes learned = learned_axes(body, movement.poses, movement.up.direction(), *start);
  const auto add = [&](std::optional<RestCandidate> pose, std::string name) {
    if (!pose) return;
    JointFromBone axes = axes_in(search, *pose);
    const double off = deviation_from_t(search.body, *pose).mean;
    const double error = expected_error_of_pose(axes, off, learned);
    scored.push_back({Rest{*std::move(pose), std::move(axes), std::move(name), {}, {}}, error});
  };
  if (meant) {
    const double error = expected_error(meant->axes, learned);
    scored.push_back({*meant, error});
  } else if (map.facts.rest != RestPose::kLearned) {
    add(zero_candidate(search), "zero pose");
    const auto best = best_frame(search);
    if (best && expected_error(learned) > kShowsLittle &&
        deviation_from_t(body, best->second).mean < kNearlyT) {
      add(best->second, "frame " + std::to_string(best->first));
    }
  }
  const double error = expected_error(learned);
  scored.push_back({Rest{*std::move(start), std::move(learned.axes), kLearnedName, {}, {}}, error});
  return scored;
}

std::string name_of(const ScoredRest& scored) {
  return scored.rest.name == kLearnedName ? "the whole movement" : scored.rest.name;
}

// Keeps an intended pose; otherwise chooses the learned axes, unless a pose is clearly better.
std::size_t chosen_of(const std::vector<ScoredRest>& scored, bool is_meant) {
  if (is_meant) return 0;
  const std::size_t movement = scored.size() - 1;
  std::size_t chosen = movement;
  for (std::size_t i = 0; i < movement; ++i) {
    const double lead = chosen == movement ? kClearLead : 0.0;
    if (scored[i].error + lead < scored[chosen].error) chosen = i;
  }
  return chosen;
}

// The best of the other candidates; `chosen` without others.
std::size_t runner_up(const std::vector<ScoredRest>& scored, std::size_t chosen) {
  std::size_t best = chosen;
  for (std::size_t i = 0; i < scored.size(); ++i) {
    if (i != chosen && (best == chosen || scored[i].error < scored[best].error)) best = i;
  }
  return best;
}

// The up direction of a standing body, from its trunk and legs.
Eigen::Vector3d standing_direction(const Body& body, const JointPoses& pose,
                                   const Eigen::Vector3d& trunk) {
  Eigen::Vector3d legs = Eigen::Vector3d::Zero();
  for (const Side side : kSides) {
    const int hip = body.joint(side_bone(side, LimbBone::kUpLeg));
    const int ankle = body.joint(side_bone(side, LimbBone::kFoot));
    if (hip >= 0 && ankle >= 0) legs += pose[hip].translation - pose[ankle].translation;
  }
  const Eigen::Vector3d up = legs.norm() > 0.0 ? Eigen::Vector3d(trunk + legs.normalized()) : trunk;
  return up.norm() > 0.5 ? Eigen::Vector3d(up.normalized()) : trunk;
}

// Explains why the user should check the choice; empty if the choice is certain.
std::string doubt_of(const ScoredRest& chosen, const ScoredRest& other, bool is_meant) {
  constexpr double kBad = 15.0, kTie = 1.0, kDiffers = 15.0;  // degrees
  const std::string hint = "; if limbs look turned, give " OPTION("rest");
  const bool is_alone = &chosen == &other;
  if (chosen.error > kBad) {
    const std::string compared =
        is_alone ? "" : fmt::format(", {} {:.0f}", name_of(other), other.error);
    return fmt::format(
        "the T-pose of {} hardly fits the movement: expected error {:.0f} degrees{}{}",
        name_of(chosen), chosen.error, compared, hint);
  }
  const bool is_tie = !is_meant && !is_alone && std::abs(chosen.error - other.error) < kTie &&
                      angle_between_axes(chosen.rest.axes, other.rest.axes) > kDiffers;
  if (!is_tie) return {};
  return fmt::format(
      "two T-poses fit the movement nearly equally well: using that of {} (expected error {:.1f} "
      "degrees) instead of that of {} ({:.1f}){}",
      name_of(chosen), chosen.error, name_of(other), other.error, hint);
}

}  // namespace

// A zero pose has its own up direction, which may differ from that of the movement. It is an axis,
// unless an exporter has turned the pose as a whole.
std::optional<RestCandidate> zero_candidate(const RestSearch& search) {
  const JointPoses pose = zero_pose(search.clip);
  const auto trunk = trunk_direction(search.body, pose);
  if (!trunk) return std::nullopt;
  auto found = candidate(search, pose, nearest_axis(*trunk).direction());
  if (!found || !is_well_formed(search.body, *found)) {
    auto turned = candidate(search, pose, standing_direction(search.body, pose, *trunk));
    if (turned && is_well_formed(search.body, *turned)) found = std::move(turned);
  }
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
    // Poses that differ only by rounding count as equal; the first one wins.
    if (best && mean > min - 1e-6) return;
    min = mean;
    best = std::pair(frame, *std::move(found));
  };
  // A T-pose before the motion is a candidate, although it is not part of the motion.
  for (int frame = 0; frame < movement.lead_in; ++frame)
    consider(frame, frame_pose(search.clip, frame));
  for (std::size_t i = 0; i < movement.poses.size(); ++i)
    consider(movement.frames[i], movement.poses[i]);
  return best;
}

Result<Rest> find_rest(const RestSearch& search) {
  if (search.options.tpose) return rest_of_tpose_file(search);
  if (search.options.rest != RestPose::kAuto) return given_rest(search);
  std::optional<Rest> meant = meant_rest(search);
  const std::vector<ScoredRest> scored = scored_rests(search, meant);
  if (scored.empty()) return meant ? Result<Rest>(*std::move(meant)) : rest_of_movement(search);
  const std::size_t chosen = chosen_of(scored, meant.has_value());
  const std::size_t other = runner_up(scored, chosen);
  Rest rest = scored[chosen].rest;
  if (other != chosen) {
    const bool is_learned = scored[other].rest.name == kLearnedName;
    rest.evidence = fmt::format(
        "expected error {:.1f} degrees; next best: {}, {:.1f} degrees", scored[chosen].error,
        is_learned ? "axes learned from the movement" : scored[other].rest.name,
        scored[other].error);
  }
  // Rotations that were computed from directions have no rest pose to choose.
  const bool is_made = search.map.facts.rest == RestPose::kLearned;
  if (!is_made && search.movement.poses.size() >= kMinPosesToCompare) {
    rest.doubt = doubt_of(scored[chosen], scored[other], meant.has_value());
  }
  return rest;
}

}  // namespace retarget
