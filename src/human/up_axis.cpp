#include "human/up_axis.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "human/body_axes.h"
#include "math/statistics.h"
#include "retarget/human.h"
#include "retarget/pose.h"

namespace retarget {
namespace {

// mean cosines of trunk and legs to an axis along which a body plainly stands, and hardly does;
// hardly any file has up along a negative axis
constexpr double kPlainly = 0.5, kMinCertainty = 0.3, kPlainlyNegative = 0.8, kBeyondDoubt = 0.95;

// y counts as up when it scores at least this share of the best axis
constexpr double kCustomShare = 0.7;

// joints of the legs' ends: ankles, knees where there are none
std::vector<int> feet_of(const Body& body) {
  std::vector<int> feet;
  for (const LimbBone part : {LimbBone::kFoot, LimbBone::kLeg}) {
    for (const Side side : kSides) {
      const int joint = body.joint(side_bone(side, part));
      if (joint >= 0) feet.push_back(joint);
    }
    if (!feet.empty()) break;
  }
  return feet;
}

// mean of the unit vectors from feet to hips and from hips to head
Eigen::Vector3d upward(const Body& body, const JointPoses& pose, const std::vector<int>& feet) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (const auto trunk = trunk_direction(body, pose)) sum += *trunk;
  for (const int foot : feet) {
    const Eigen::Vector3d leg = pose[body.joint(Bone::kHips)].translation - pose[foot].translation;
    // without length it is no direction, which normalized() leaves as zero
    sum += leg.normalized() / static_cast<double>(feet.size());
  }
  return 0.5 * sum;
}

// of the lowest joint along a direction, in all poses
std::vector<double> lowest_levels(const std::vector<JointPoses>& poses, const Eigen::Vector3d& up) {
  std::vector<double> lowest;
  for (const JointPoses& pose : poses) {
    double min = std::numeric_limits<double>::infinity();
    for (const Pose& joint : pose) min = std::min(min, up.dot(joint.translation));
    lowest.push_back(min);
  }
  return lowest;
}

double size_of(const Body& body) {
  double size = 0.0;
  for (const Bone bone : {Bone::kLeftUpLeg, Bone::kLeftLeg, Bone::kRightUpLeg, Bone::kRightLeg}) {
    size += 0.5 * length_by_offsets(body, bone);
  }
  return size;
}

// how far the lowest joint wanders along an axis, from the tenth to the fiftieth percentile of the
// poses so that jumps do not count, in legs, at most 1
double floor_wander(const Body& body, const std::vector<JointPoses>& poses, const SignedAxis& up) {
  const double leg = size_of(body);
  const std::vector<double> lowest = lowest_levels(poses, up.direction());
  if (leg <= 0.0 || lowest.empty()) return 0.0;
  return std::min((median(lowest) - percentile(lowest, 10.0)) / leg, 1.0);
}

// whether the body is on a floor at height 0 along an axis: half of the poses have their lowest joint
// within a fifth of a leg's length of it, as nearly all recordings have along up
bool is_on_floor(const Body& body, const std::vector<JointPoses>& poses, const SignedAxis& up) {
  constexpr double kNear = 0.2;  // of a leg
  const std::vector<double> lowest = lowest_levels(poses, up.direction());
  return !lowest.empty() && std::abs(median(lowest)) <= kNear * size_of(body);
}

// The file's up axis by what the movement shows: the axis along which, over the poses, the head stays
// above the hips and these above the feet, on average, and above which the lowest joint wanders
// least. y, BVH's custom, is taken when it does nearly as well as the best, and when the body lies:
// the lowest joint keeps much stiller along y than along the best.
struct UpGuess {
  SignedAxis axis;
  double certainty = 0.0;  // mean cosine of the trunk and the legs to the axis
};

UpGuess guess_up(const Body& body, const std::vector<JointPoses>& poses) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const std::vector<int> feet = feet_of(body);
  for (const JointPoses& pose : poses) mean += upward(body, pose, feet);
  mean /= static_cast<double>(std::max<std::size_t>(poses.size(), 1));

  // a floor that wanders by a whole leg counts as much as a trunk that leans by 60 degrees
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
  const SignedAxis custom;
  const bool is_near = score(custom) > 0.0 && score(custom) >= kCustomShare * score(best);
  // a body that lies: nothing stands along y, but the floor keeps still there
  const bool lies = mean.dot(custom.direction()) > -0.3 && floor(best) > 0.02 &&
                    floor(custom) < 0.4 * floor(best);
  if (is_near || lies) best = custom;
  return {best, mean.dot(best.direction())};
}

// whether a body plainly stands along another axis than all others of its kind; people who lie may
// seem to for a moment
bool stands_otherwise(const Body& body, const std::vector<JointPoses>& poses, const UpGuess& guess,
                      const SignedAxis& custom) {
  constexpr std::size_t kMinFrames = 15;  // one and a half seconds
  if (poses.size() < kMinFrames) return false;
  // who lies all the time lies on the floor
  if (is_on_floor(body, poses, custom) && !is_on_floor(body, poses, guess.axis)) return false;
  return guess.axis != custom && guess.certainty > (guess.axis.negative ? kBeyondDoubt : kPlainly);
}

// whether the lowest joint keeps to height 0 along the guessed axis alone
bool floor_speaks_for(const Body& body, const std::vector<JointPoses>& poses,
                      const SignedAxis& guessed, const SignedAxis& other) {
  constexpr double kStill = 0.1;  // of a leg
  const auto has_floor = [&](const SignedAxis& axis) {
    return is_on_floor(body, poses, axis) && floor_wander(body, poses, axis) < kStill;
  };
  return has_floor(guessed) && !has_floor(other);
}

}  // namespace

UpChoice choose_up(const Body& body, const std::vector<JointPoses>& poses, const KnownUp& known) {
  if (poses.empty()) {
    return {known.of_kind.value_or(known.of_zero_pose.value_or(SignedAxis{}))};
  }
  const UpGuess guess = guess_up(body, poses);
  if (known.of_kind && !stands_otherwise(body, poses, guess, *known.of_kind)) {
    return {*known.of_kind};
  }
  UpChoice choice{guess.axis, guess.certainty < kMinCertainty};
  const double plainly = guess.axis.negative ? kPlainlyNegative : kPlainly;
  if (known.of_zero_pose && guess.certainty < plainly &&
      !floor_speaks_for(body, poses, guess.axis, *known.of_zero_pose)) {
    choice.axis = *known.of_zero_pose;
  }
  return choice;
}

}  // namespace retarget
