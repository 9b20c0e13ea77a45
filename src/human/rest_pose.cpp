#include "human/rest_pose.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "human/canonical_pose.h"
#include "math/so3.h"

namespace retarget {
namespace {

using enum LimbBone;

// the body's axes: x forward, y left, z up
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

// unit direction of a bone in the body's axes
std::optional<Eigen::Vector3d> heading(const Body& body, const RestCandidate& candidate,
                                       Bone bone) {
  const auto way = along(body.segment(bone), candidate.pose);
  if (!way) return std::nullopt;
  return (candidate.axes * *way).normalized();
}

// the foot's direction on the floor after a turn; nothing when it hardly has one
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
  constexpr double kMostAhead = 0.5;     // sine of 30 degrees out of the frontal plane
  constexpr double kMostRaised = 0.5;    // of 30 degrees above the shoulder
  constexpr double kMostInward = -0.35;  // of 20 degrees across the body
  constexpr double kMostBent = 35.0;     // degrees at the elbow
  return std::abs(upper->x()) < kMostAhead && upper->z() < kMostRaised &&
         upper->dot(outward(side)) > kMostInward &&
         (!lower || degrees_between(*upper, *lower) < kMostBent);
}

bool leg_is_well_formed(const Body& body, const RestCandidate& candidate, Side side) {
  constexpr double kMostSplayed = 35.0;  // degrees
  for (const LimbBone part : {kUpLeg, kLeg}) {
    const auto way = heading(body, candidate, side_bone(side, part));
    if (way && degrees_between(*way, -up()) > kMostSplayed) return false;
  }
  const auto foot = foot_heading(body, candidate, side, Eigen::Matrix3d::Identity());
  return !foot || foot->dot(ahead()) > 0.5;
}

// rotation of a chain's next bone that takes it to `target`, after `carried` by the one above
Eigen::Matrix3d turned_on(const std::optional<Eigen::Vector3d>& way, const Eigen::Vector3d& target,
                          const Eigen::Matrix3d& carried) {
  if (!way) return carried;
  return least_rotation(carried * *way, target, ahead()) * carried;
}

// rotations in the body's axes that bring the joints of a pose to the T-pose
class Straightening {
 public:
  Straightening(const Body& body, const RestCandidate& candidate)
      : body_(body), candidate_(candidate) {
    for (const Side side : kSides) {
      straighten_arm(side);
      straighten_leg(side);
    }
  }

  [[nodiscard]] const Eigen::Matrix3d& turn(Bone bone) const { return turns_[bone]; }

 private:
  Eigen::Matrix3d& of(Bone bone) { return turns_[bone]; }
  [[nodiscard]] std::optional<Eigen::Vector3d> way(Bone bone) const {
    return heading(body_, candidate_, bone);
  }

  void straighten_arm(Side side) {
    const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
    const Eigen::Vector3d out = outward(side);
    of(side_bone(side, kShoulder)) = turned_on(way(side_bone(side, kShoulder)), out, none);
    of(side_bone(side, kArm)) = turned_on(way(side_bone(side, kArm)), out, none);
    of(side_bone(side, kForeArm)) =
        turned_on(way(side_bone(side, kForeArm)), out, of(side_bone(side, kArm)));
    of(side_bone(side, kHand)) = of(side_bone(side, kForeArm));
  }

  void straighten_leg(Side side) {
    const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
    of(side_bone(side, kUpLeg)) = turned_on(way(side_bone(side, kUpLeg)), -up(), none);
    of(side_bone(side, kLeg)) =
        turned_on(way(side_bone(side, kLeg)), -up(), of(side_bone(side, kUpLeg)));
    straighten_foot(side, candidate_.is_built ? of(side_bone(side, kLeg)) : none);
  }

  void straighten_foot(Side side, const Eigen::Matrix3d& carried) {
    of(side_bone(side, kToe)) = carried;
    of(side_bone(side, kFoot)) = carried;
    const auto toes = foot_heading(body_, candidate_, side, carried);
    if (!toes) return;
    const Eigen::Matrix3d yaw = least_rotation(*toes, ahead(), up()) * carried;
    of(side_bone(side, kToe)) = yaw;
    of(side_bone(side, kFoot)) = yaw;
    if (body_.has(side_bone(side, kToe))) {
      const Bone bone = side_bone(side, kFoot);
      of(side_bone(side, kFoot)) =
          turned_on(way(side_bone(side, kFoot)), canonical_t_pose(bone).col(0), yaw);
    }
  }

  const Body& body_;
  const RestCandidate& candidate_;
  BoneArray<Eigen::Matrix3d> turns_{Eigen::Matrix3d(Eigen::Matrix3d::Identity())};
};

}  // namespace

Deviation deviation_from_t(const Body& body, const RestCandidate& candidate) {
  std::vector<double> angles;
  const auto hold = [&](const std::optional<Eigen::Vector3d>& way, const Eigen::Vector3d& target) {
    if (way) angles.push_back(degrees_between(*way, target));
  };
  for (const Side side : kSides) {
    hold(heading(body, candidate, side_bone(side, kArm)), outward(side));
    hold(heading(body, candidate, side_bone(side, kForeArm)), outward(side));
    hold(heading(body, candidate, side_bone(side, kUpLeg)), -up());
    hold(heading(body, candidate, side_bone(side, kLeg)), -up());
  }
  if (const auto trunk = trunk_direction(body, candidate.pose)) {
    hold(candidate.axes * *trunk, up());
  }
  if (angles.empty()) return {};
  double sum = 0.0;
  for (const double angle : angles) sum += angle;
  return {sum / static_cast<double>(angles.size()), *std::ranges::max_element(angles)};
}

bool is_well_formed(const Body& body, const RestCandidate& candidate) {
  constexpr double kMostLeaning = 20.0;  // degrees
  const auto trunk = trunk_direction(body, candidate.pose);
  if (trunk && degrees_between(candidate.axes * *trunk, up()) > kMostLeaning) return false;
  for (const Side side : kSides) {
    if (!arm_is_well_formed(body, candidate, side)) return false;
    if (!leg_is_well_formed(body, candidate, side)) return false;
  }
  return true;
}

JointFromBone bring_to_t(const Body& body, const RestCandidate& candidate) {
  const Straightening straightening(body, candidate);
  JointFromBone joint_from_bone;
  for (const Bone bone : kMappedBones) {
    const int joint = body.turning_joint(bone);
    if (joint < 0) continue;
    const Eigen::Matrix3d t_from_joint = straightening.turn(bone) * candidate.axes *
                                         candidate.pose[joint].rotation.toRotationMatrix();
    joint_from_bone[bone] = t_from_joint.transpose() * canonical_t_pose(bone);
  }
  return joint_from_bone;
}

}  // namespace retarget
