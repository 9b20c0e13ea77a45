#include "human/skeleton/rest_pose.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "retarget/statistics.h"

namespace retarget {
namespace {

using enum LimbBone;

// Body axes: x forward, y left, z up.
Eigen::Vector3d ahead() {
  return Eigen::Vector3d::UnitX();
}
Eigen::Vector3d up() {
  return Eigen::Vector3d::UnitZ();
}
Eigen::Vector3d outward(Side side) {
  return side == Side::kLeft ? Eigen::Vector3d::UnitY()
                             : Eigen::Vector3d(-Eigen::Vector3d::UnitY());
}

constexpr double kDegree = 57.295779513082321;

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return kDegree * angle_between(a, b);
}

// Unit direction of a bone in body axes.
std::optional<Eigen::Vector3d> heading(const Body& body, const RestCandidate& candidate,
                                       Bone bone) {
  const auto way = along(body.segment(bone), candidate.pose);
  if (!way) return std::nullopt;
  return (candidate.axes * *way).normalized();
}

// Horizontal direction of the foot after a turn; nothing if it is nearly vertical.
std::optional<Eigen::Vector3d> foot_heading(const Body& body, const RestCandidate& candidate,
                                            Side side, const Eigen::Matrix3d& turn) {
  for (const LimbBone part : {kFoot, kToe}) {
    auto way = heading(body, candidate, side_bone(side, part));
    if (!way) continue;
    *way = turn * *way;
    way->z() = 0.0;
    if (way->norm() > 0.3) return way->normalized();
  }
  return std::nullopt;
}

bool arm_is_well_formed(const Body& body, const RestCandidate& candidate, Side side) {
  const auto upper = heading(body, candidate, side_bone(side, kArm));
  const auto lower = heading(body, candidate, side_bone(side, kForeArm));
  if (!upper) return true;
  constexpr double kMaxAhead = 0.5;     // Sine of 30 degrees out of the frontal plane.
  constexpr double kMaxRaised = 0.5;    // Sine of 30 degrees above the shoulder.
  constexpr double kMaxInward = -0.35;  // Sine of 20 degrees across the body.
  constexpr double kMaxBent = 35.0;     // Degrees at the elbow.
  return std::abs(upper->x()) < kMaxAhead && upper->z() < kMaxRaised &&
         upper->dot(outward(side)) > kMaxInward &&
         (!lower || degrees_between(*upper, *lower) < kMaxBent);
}

bool leg_is_well_formed(const Body& body, const RestCandidate& candidate, Side side) {
  constexpr double kMaxSplayed = 35.0;  // Degrees.
  for (const LimbBone part : {kUpLeg, kLeg}) {
    const auto way = heading(body, candidate, side_bone(side, part));
    if (way && degrees_between(*way, -up()) > kMaxSplayed) return false;
  }
  const auto foot = foot_heading(body, candidate, side, Eigen::Matrix3d::Identity());
  return !foot || foot->dot(ahead()) > 0.5;
}

// Rotates a bone to `target`, given the rotation `carried` of the bone above it.
Eigen::Matrix3d turned_on(const std::optional<Eigen::Vector3d>& way, const Eigen::Vector3d& target,
                          const Eigen::Matrix3d& carried) {
  if (!way) return carried;
  return minimal_rotation(carried * *way, target, ahead()) * carried;
}

// Rotations in body axes that bring the joints of a pose to the T-pose.
BoneArray<Eigen::Matrix3d> straightening(const Body& body, const RestCandidate& candidate) {
  const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  BoneArray<Eigen::Matrix3d> turns{none};
  for (const Side side : kSides) {
    const auto turn = [&](LimbBone part) -> Eigen::Matrix3d& {
      return turns[side_bone(side, part)];
    };
    const auto straighten = [&](LimbBone part, const Eigen::Vector3d& target,
                                const Eigen::Matrix3d& carried) {
      turn(part) = turned_on(heading(body, candidate, side_bone(side, part)), target, carried);
    };
    straighten(kShoulder, outward(side), none);
    straighten(kArm, outward(side), none);
    straighten(kForeArm, outward(side), turn(kArm));
    turn(kHand) = turn(kForeArm);
    straighten(kUpLeg, -up(), none);
    straighten(kLeg, -up(), turn(kUpLeg));
    turn(kToe) = candidate.is_built ? turn(kLeg) : none;
    const auto toes = foot_heading(body, candidate, side, turn(kToe));
    if (toes) turn(kToe) = minimal_rotation(*toes, ahead(), up()) * turn(kToe);
    turn(kFoot) = turn(kToe);
    if (toes && body.has(side_bone(side, kToe))) {
      straighten(kFoot, canonical_t_pose(side_bone(side, kFoot)).col(0), turn(kToe));
    }
  }
  return turns;
}

}  // namespace

Deviation deviation_from_t(const Body& body, const RestCandidate& candidate) {
  std::vector<double> angles;
  const auto hold = [&](const std::optional<Eigen::Vector3d>& way, const Eigen::Vector3d& target) {
    if (way) angles.push_back(degrees_between(*way, target));
  };
  for (const Side side : kSides) {
    for (const LimbBone part : {kArm, kForeArm, kUpLeg, kLeg}) {
      const bool of_arm = part == kArm || part == kForeArm;
      hold(heading(body, candidate, side_bone(side, part)), of_arm ? outward(side) : -up());
    }
  }
  if (const auto trunk = trunk_direction(body, candidate.pose)) {
    hold(candidate.axes * *trunk, up());
  }
  if (angles.empty()) return {};
  return {mean(angles), *std::ranges::max_element(angles)};
}

bool is_well_formed(const Body& body, const RestCandidate& candidate) {
  constexpr double kMaxLeaning = 20.0;  // Degrees.
  const auto trunk = trunk_direction(body, candidate.pose);
  if (trunk && degrees_between(candidate.axes * *trunk, up()) > kMaxLeaning) return false;
  for (const Side side : kSides) {
    if (!arm_is_well_formed(body, candidate, side)) return false;
    if (!leg_is_well_formed(body, candidate, side)) return false;
  }
  return true;
}

JointFromBone bring_to_t(const Body& body, const RestCandidate& candidate) {
  const BoneArray<Eigen::Matrix3d> turns = straightening(body, candidate);
  JointFromBone joint_from_bone;
  for (const Bone bone : kMappedBones) {
    const int joint = body.turning_joint(bone);
    if (joint < 0) continue;
    const Eigen::Matrix3d t_from_joint =
        turns[bone] * candidate.axes * candidate.pose[joint].rotation.toRotationMatrix();
    joint_from_bone[bone] = t_from_joint.transpose() * canonical_t_pose(bone);
  }
  return joint_from_bone;
}

}  // namespace retarget
