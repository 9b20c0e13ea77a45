#include "human/skeleton/rest_pose.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>
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

std::vector<std::string> forearms_without_length(const Body& body, const JointPoses& pose) {
  std::vector<std::string> names;
  for (const Side side : kSides) {
    const Bone forearm = side_bone(side, kForeArm);
    if (!body.has(forearm) || along(body.segment(forearm), pose)) continue;
    names.push_back(body.skeleton().joint(body.joint(forearm)).name);
  }
  return names;
}

namespace {

constexpr double kForearmPerUpperArm = 0.8;
// Ankle to ball of the foot per length of thigh and shin, from LAFAN1's body.
constexpr double kFootPerLeg = 0.2;

class Sources {
 public:
  Sources(const Body& body, const JointFromBone& axes, const JointPoses& rest)
      : body_(body), axes_(axes), rest_(rest) {
    for (const Bone bone : kMappedBones) {
      if (is_mapped(bone)) {
        place(bone, body.joint(bone), body.turning_joint(bone), *axes[bone]);
      }
    }
    fill_trunk();
    for (const Side side : kSides) {
      fill_arm(side);
      fill_foot(side);
    }
  }

  BoneArray<BoneSource> take() { return std::move(sources_); }

 private:
  [[nodiscard]] bool is_mapped(Bone bone) const {
    return body_.joint(bone) >= 0 && axes_[bone].has_value();
  }

  void place(Bone bone, int position_joint, int rotation_joint, const Eigen::Matrix3d& axes) {
    sources_[bone] = {position_joint, rotation_joint, Eigen::Quaterniond(axes).normalized()};
  }

  // Attaches a bone rigidly to `like`, with their relative rotation in the T-pose.
  void turn_with(Bone bone, Bone like, int position_joint) {
    place(bone, position_joint, body_.turning_joint(like),
          *axes_[like] * canonical_t_pose(like).transpose() * canonical_t_pose(bone));
  }

  // As turn_with, at the far end of `like` or at `length` along it. Does nothing if both are
  // unknown.
  void hang_from(Bone bone, Bone like, const std::optional<double>& length = std::nullopt) {
    const Segment& end = body_.segment(like);
    if (!end.known() && !length) return;
    turn_with(bone, like, end.known() ? end.end_joint : body_.joint(like));
    sources_[bone].position_in_joint =
        end.known() ? end.offset : Eigen::Vector3d(length.value_or(0.0) * axes_[like]->col(0));
  }

  void fill_from_first(Bone bone, std::initializer_list<Bone> neighbours) {
    if (is_mapped(bone)) return;
    const auto* const found =
        std::ranges::find_if(neighbours, [this](Bone other) { return is_mapped(other); });
    if (found != neighbours.end()) turn_with(bone, *found, body_.joint(*found));
  }

  void fill_trunk() {
    fill_from_first(Bone::kSpine2, {Bone::kSpine1, Bone::kSpine, Bone::kHips});
    fill_from_first(Bone::kSpine1, {Bone::kSpine2, Bone::kSpine, Bone::kHips});
    fill_from_first(Bone::kSpine, {Bone::kSpine1, Bone::kSpine2, Bone::kHips});
    fill_from_first(Bone::kNeck, {Bone::kHead});
    if (!is_mapped(Bone::kHead) && is_mapped(Bone::kNeck)) hang_from(Bone::kHead, Bone::kNeck);
  }

  void fill_arm(Side side) {
    const Bone clavicle = side_bone(side, kShoulder), arm = side_bone(side, kArm);
    const Bone forearm = side_bone(side, kForeArm), hand = side_bone(side, kHand);
    if (!is_mapped(clavicle) && is_mapped(Bone::kSpine2) && is_mapped(arm)) {
      turn_with(clavicle, Bone::kSpine2, body_.joint(arm));
    }
    if (is_mapped(hand) || !is_mapped(forearm)) return;
    const double upper_arm = body_.skeleton().joint(body_.joint(forearm)).offset.norm();
    hang_from(hand, forearm, kForearmPerUpperArm * upper_arm);
    // An end site at the elbow is not a hand.
    if (!along(body_.segment(forearm), rest_)) {
      turn_with(hand, forearm, body_.joint(forearm));
      sources_[hand].position_in_joint = kForearmPerUpperArm * upper_arm * axes_[forearm]->col(0);
    }
  }

  void fill_foot(Side side) {
    const Bone foot = side_bone(side, kFoot), toe = side_bone(side, kToe);
    if (!is_mapped(foot)) return;
    turn_with(side_bone(side, kFootMod), is_mapped(toe) ? toe : foot, body_.joint(foot));
    if (is_mapped(toe)) return;
    const auto thigh = along(body_.segment(side_bone(side, kUpLeg)), rest_);
    const auto shin = along(body_.segment(side_bone(side, kLeg)), rest_);
    // Without toes or an end site, use LAFAN1's proportion.
    hang_from(
        toe, foot,
        thigh && shin ? std::optional(kFootPerLeg * (thigh->norm() + shin->norm())) : std::nullopt);
  }

  const Body& body_;
  const JointFromBone& axes_;
  const JointPoses& rest_;
  BoneArray<BoneSource> sources_;
};

}  // namespace

BoneArray<BoneSource> bone_sources(const Body& body, const JointFromBone& axes,
                                   const JointPoses& rest) {
  return Sources(body, axes, rest).take();
}

}  // namespace retarget
