#include "human/skeleton/up_guess.h"

#include <algorithm>
#include <limits>

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

// Variation of the lowest joint's level along an axis: tenth to fiftieth percentile of the poses,
// which excludes jumps; in legs, at most 1.
double floor_wander(const Body& body, const std::vector<JointPoses>& poses, const SignedAxis& up) {
  const double leg = leg_length(body);
  const std::vector<double> lowest = lowest_levels(poses, up.direction());
  if (leg <= 0.0 || lowest.empty()) return 0.0;
  return std::min((median(lowest) - percentile(lowest, 10.0)) / leg, 1.0);
}

}  // namespace

UpGuess guess_up(const Body& body, const std::vector<JointPoses>& poses) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const std::vector<int> feet = feet_of(body);
  for (const JointPoses& pose : poses) mean += upward(body, pose, feet);
  mean /= static_cast<double>(std::max<std::size_t>(poses.size(), 1));

  // A floor that varies by a whole leg counts as much as a trunk that leans by 60 degrees.
  const auto floor = [&](const SignedAxis& axis) { return floor_wander(body, poses, axis); };
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
  // For a lying body nothing stands along y, but the floor is constant there.
  const bool lies = mean.dot(custom.direction()) > -0.3 && floor(best) > 0.02 &&
                    floor(custom) < 0.4 * floor(best);
  if (is_near || lies) best = custom;
  return {best, mean.dot(best.direction())};
}

}  // namespace retarget
