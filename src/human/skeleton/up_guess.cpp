#include "human/skeleton/up_guess.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "human/skeleton/floor_slope.h"
#include "human/skeleton/up_evidence.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

// End joints of the legs: ankles, or knees if there are no ankles.
std::vector<int> feet_of(const Body& body) {
  std::vector<int> feet = body.joints_of(LimbBone::kFoot);
  return feet.empty() ? body.joints_of(LimbBone::kLeg) : feet;
}

// Mean of the unit vectors from feet to hips and from hips to head.
Eigen::Vector3d upward(const Body& body, const JointPoses& pose, const std::vector<int>& feet) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (const auto trunk = trunk_direction(body, pose)) sum += *trunk;
  for (const int foot : feet) {
    const Eigen::Vector3d leg = pose[body.joint(Bone::kHips)].translation - pose[foot].translation;
    // normalized() leaves a zero vector unchanged.
    sum += leg.normalized() / static_cast<double>(feet.size());
  }
  return 0.5 * sum;
}

// Levels of the lowest joint along a direction, by pose.
std::vector<double> lowest_levels(const std::vector<JointPoses>& poses, const Eigen::Vector3d& up) {
  std::vector<double> lowest;
  for (const JointPoses& pose : poses) {
    double min = std::numeric_limits<double>::infinity();
    for (const Pose& joint : pose) min = std::min(min, up.dot(joint.translation));
    lowest.push_back(min);
  }
  return lowest;
}

// Variation of heights: tenth to fiftieth percentile of the poses, which excludes jumps; in legs, at
// most 1.
double wander_of(const std::vector<double>& heights, double leg) {
  if (leg <= 0.0 || heights.empty()) return 0.0;
  return std::min((median(heights) - percentile(heights, 10.0)) / leg, 1.0);
}

// Positions of the hips, in legs.
std::vector<Eigen::Vector3d> hip_places(const Body& body, const std::vector<JointPoses>& poses,
                                        double leg) {
  std::vector<Eigen::Vector3d> places;
  for (const JointPoses& pose : poses) {
    places.emplace_back(pose[body.joint(Bone::kHips)].translation / leg);
  }
  return places;
}

// Whether the lowest joint varies much less along an axis than along another one, also if the floor
// of that one has a slope.
bool has_steadier_floor(const Body& body, const std::vector<JointPoses>& poses,
                        const SignedAxis& axis, const SignedAxis& other) {
  constexpr double kStill = 0.02, kMuchLess = 0.4;
  const double leg = leg_length(body);
  std::vector<double> heights = lowest_levels(poses, other.direction());
  double wander = wander_of(heights, leg);
  if (leg > 0.0 && body.has(Bone::kHips)) {
    for (double& height : heights) height /= leg;
    heights = without_slope(std::move(heights), hip_places(body, poses, leg), other.axis);
    wander = std::min(wander, wander_of(heights, 1.0));
  }
  const double own = wander_of(lowest_levels(poses, axis.direction()), leg);
  return wander > kStill && own < kMuchLess * wander;
}

// A centred motion lies on no floor; its feet rise when it squats.
bool is_centred_and_stands(const Body& body, const std::vector<JointPoses>& poses, double upright) {
  constexpr double kStands = 0.7;
  const double leg = leg_length(body);
  return upright > kStands && leg > 0.0 && body.has(Bone::kHips) &&
         is_centred(hip_places(body, poses, leg));
}

}  // namespace

UpGuess guess_up(const Body& body, const std::vector<JointPoses>& poses) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const std::vector<int> feet = feet_of(body);
  for (const JointPoses& pose : poses) mean += upward(body, pose, feet);
  mean /= static_cast<double>(std::max<std::size_t>(poses.size(), 1));

  // A floor that varies by a whole leg counts as much as a trunk that leans by 60 degrees.
  const auto floor = [&](const SignedAxis& axis) {
    return wander_of(lowest_levels(poses, axis.direction()), leg_length(body));
  };
  const auto score = [&](const SignedAxis& axis) {
    return mean.dot(axis.direction()) - 0.5 * floor(axis);
  };
  SignedAxis best;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool negative : {false, true}) {
      if (score({axis, negative}) > score(best)) best = {axis, negative};
    }
  }
  // y counts as up if it scores at least this share of the best axis.
  constexpr double kCustomShare = 0.7;
  const SignedAxis custom;
  const bool is_near = score(custom) > 0.0 && score(custom) >= kCustomShare * score(best);
  const bool lies = mean.dot(custom.direction()) > -0.3 &&
                    !is_centred_and_stands(body, poses, mean.dot(best.direction())) &&
                    has_steadier_floor(body, poses, custom, best);
  if (is_near || lies) best = custom;
  return {best, mean.dot(best.direction())};
}

}  // namespace retarget
