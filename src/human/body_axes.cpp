#include "human/body_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace retarget {
namespace {

// y counts as up when it scores at least this share of the best axis
constexpr double kCustomShare = 0.7;

void add_unit(Eigen::Vector3d& sum, const Eigen::Vector3d& way) {
  if (way.norm() > 0.0) sum += way.normalized();
}

// joints of the legs' ends: ankles, knees where there are none
std::vector<int> feet_of(const Body& body) {
  std::vector<int> feet;
  for (const Bone bone : {Bone::kLeftFoot, Bone::kRightFoot}) {
    if (body.has(bone)) feet.push_back(body.joint(bone));
  }
  if (!feet.empty()) return feet;
  for (const Bone bone : {Bone::kLeftLeg, Bone::kRightLeg}) {
    if (body.has(bone)) feet.push_back(body.joint(bone));
  }
  return feet;
}

// mean of the unit vectors from feet to hips and from hips to head
Eigen::Vector3d upward(const Body& body, const JointPoses& pose, const std::vector<int>& feet) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (const auto trunk = trunk_direction(body, pose)) sum += *trunk;
  for (const int foot : feet) {
    Eigen::Vector3d leg = Eigen::Vector3d::Zero();
    add_unit(leg, pose[body.joint(Bone::kHips)].translation - pose[foot].translation);
    sum += leg / static_cast<double>(feet.size());
  }
  return 0.5 * sum;
}

// of the lowest joint along a direction, in all poses, sorted
std::vector<double> lowest_levels(const std::vector<JointPoses>& poses, const Eigen::Vector3d& up) {
  std::vector<double> lowest;
  for (const JointPoses& pose : poses) {
    double least = std::numeric_limits<double>::infinity();
    for (const Pose& joint : pose) least = std::min(least, up.dot(joint.translation));
    lowest.push_back(least);
  }
  std::ranges::sort(lowest);
  return lowest;
}

// how far the lowest joint of the body wanders along a direction: from the tenth to the fiftieth
// percentile, so that jumps do not count
double wander(const std::vector<JointPoses>& poses, const Eigen::Vector3d& up) {
  const std::vector<double> lowest = lowest_levels(poses, up);
  if (lowest.empty()) return 0.0;
  return lowest[lowest.size() / 2] - lowest[lowest.size() / 10];
}

double size_of(const Body& body) {
  double size = 0.0;
  for (const Bone bone : {Bone::kLeftUpLeg, Bone::kLeftLeg, Bone::kRightUpLeg, Bone::kRightLeg}) {
    size += 0.5 * length_by_offsets(body, bone);
  }
  return size;
}

}  // namespace

std::optional<BodyFromFile> body_axes(const Body& body, const JointPoses& pose,
                                      const Eigen::Vector3d& up) {
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  for (const LimbBone part : {LimbBone::kUpLeg, LimbBone::kArm}) {
    const int l = body.joint(side_bone(Side::kLeft, part));
    const int r = body.joint(side_bone(Side::kRight, part));
    if (l >= 0 && r >= 0) left += pose[l].translation - pose[r].translation;
  }
  const double length = left.norm();
  left -= left.dot(up) * up;
  // written so that no number is refused too
  if (!(left.norm() > 0.2 * length)) return std::nullopt;
  return told_axes(left.normalized().cross(up), up);
}

BodyFromFile told_axes(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
  const Eigen::Vector3d ahead = (forward - forward.dot(up) * up).normalized();
  BodyFromFile axes;
  axes << ahead.transpose(), up.cross(ahead).transpose(), up.transpose();
  return axes;
}

SignedAxis nearest_axis(const Eigen::Vector3d& direction) {
  SignedAxis nearest;
  direction.cwiseAbs().maxCoeff(&nearest.axis);
  nearest.negative = direction[nearest.axis] < 0.0;
  return nearest;
}

std::optional<Eigen::Vector3d> trunk_direction(const Body& body, const JointPoses& pose) {
  for (const Bone bone : {Bone::kHead, Bone::kNeck, Bone::kSpine2, Bone::kSpine1, Bone::kSpine}) {
    if (!body.has(bone)) continue;
    const Eigen::Vector3d way =
        pose[body.joint(bone)].translation - pose[body.joint(Bone::kHips)].translation;
    if (way.norm() > 0.0) return way.normalized();
  }
  return std::nullopt;
}

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

double floor_wander(const Body& body, const std::vector<JointPoses>& poses, const SignedAxis& up) {
  const double leg = size_of(body);
  return leg <= 0.0 ? 0.0 : std::min(wander(poses, up.direction()) / leg, 1.0);
}

bool is_on_floor(const Body& body, const std::vector<JointPoses>& poses, const SignedAxis& up) {
  constexpr double kNear = 0.2;  // of a leg
  const std::vector<double> lowest = lowest_levels(poses, up.direction());
  return !lowest.empty() && std::abs(lowest[lowest.size() / 2]) <= kNear * size_of(body);
}

Eigen::Matrix3d z_up_from_file(const SignedAxis& up) {
  Eigen::Matrix3d turn;
  if (up.axis == 1 && !up.negative) turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  if (up.axis == 1 && up.negative) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  if (up.axis == 2 && !up.negative) turn << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  if (up.axis == 2 && up.negative) turn << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  if (up.axis == 0 && !up.negative) turn << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  if (up.axis == 0 && up.negative) turn << 0, 1, 0, 0, 0, -1, -1, 0, 0;
  return turn;
}

}  // namespace retarget
