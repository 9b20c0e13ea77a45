#include "human/limb_directions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "human/body_axes.h"
#include "human/canonical_pose.h"
#include "human/posed_body.h"

namespace retarget {
namespace {

using enum LimbBone;

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::array kLimbBones = {Bone::kLeftUpLeg,   Bone::kLeftLeg,     Bone::kLeftArm,
                                   Bone::kLeftForeArm, Bone::kRightUpLeg,  Bone::kRightLeg,
                                   Bone::kRightArm,    Bone::kRightForeArm};

// the square of the sine of a bend at which its plane counts as much as that of the frame before
constexpr double kBendThatCounts = 0.01;
// the sine of a bend that says for itself which way the limb bends
constexpr double kPlainBend = 0.35;

// the component of a vector across a unit vector, unit length; nothing when there is none
std::optional<Vector3d> across(const Vector3d& vector, const Vector3d& unit) {
  const Vector3d rest = vector - vector.dot(unit) * unit;
  if (!(rest.norm() > 1e-6 * vector.norm())) return std::nullopt;
  return Vector3d(rest.normalized());
}

// axes with an exact X and Z as near as it can be
Matrix3d axes_along(const Vector3d& x, const Vector3d& z) {
  Matrix3d axes;
  axes.col(0) = x;
  axes.col(2) = across(z, x).value_or(x.unitOrthogonal());
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// the positions of mapped joints in all frames, and what is seen of a body in them
class Positions {
 public:
  Positions(const Clip& clip, const Body& body) : body_(body) {
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      poses_.push_back(frame_pose(clip, frame));
    }
  }

  [[nodiscard]] int frame_count() const { return static_cast<int>(poses_.size()); }
  [[nodiscard]] const JointPoses& pose(int frame) const {
    return poses_[static_cast<std::size_t>(frame)];
  }
  [[nodiscard]] bool has(Bone bone) const { return body_.has(bone); }
  [[nodiscard]] Vector3d at(int frame, Bone bone) const {
    return pose(frame)[static_cast<std::size_t>(body_.joint(bone))].translation;
  }

  // from one bone's joint to another's, unit length
  [[nodiscard]] std::optional<Vector3d> way(int frame, Bone from, Bone to) const {
    if (!has(from) || !has(to)) return std::nullopt;
    const Vector3d line = at(frame, to) - at(frame, from);
    if (!(line.norm() > 1e-9)) return std::nullopt;
    return Vector3d(line.normalized());
  }

  // from right to left
  [[nodiscard]] std::optional<Vector3d> left_of(int frame, LimbBone part) const {
    return way(frame, side_bone(Side::kRight, part), side_bone(Side::kLeft, part));
  }

  [[nodiscard]] Vector3d trunk(int frame) const {
    return trunk_direction(body_, pose(frame)).value_or(Vector3d::UnitY());
  }

 private:
  const Body& body_;
  std::vector<JointPoses> poses_;
};

// World rotations of one bone, by frame.
using Track = std::vector<Matrix3d>;

class DirectionRotations {
 public:
  DirectionRotations(const Clip& clip, const Body& body) : positions_(clip, body), body_(body) {
    make_trunk();
    for (const Side side : kSides) {
      make_limb(side, kUpLeg, kLeg, kFoot);
      make_limb(side, kArm, kForeArm, kHand);
      make_clavicle(side);
      make_ends(side);
    }
  }

  // empty: the bone is not mapped
  [[nodiscard]] const Track& of(Bone bone) const { return tracks_[bone]; }
  [[nodiscard]] const Positions& positions() const { return positions_; }

 private:
  Track& track(Bone bone) { return tracks_[bone]; }
  [[nodiscard]] int frames() const { return positions_.frame_count(); }

  // the line across hips, shoulders, or both, and where there is none the other
  [[nodiscard]] Vector3d left(int frame, bool hips, bool shoulders) const {
    const auto of_hips = positions_.left_of(frame, kUpLeg);
    const auto of_shoulders = positions_.left_of(frame, kArm);
    Vector3d sum = Vector3d::Zero();
    if (of_hips && (hips || !of_shoulders)) sum += *of_hips;
    if (of_shoulders && (shoulders || !of_hips)) sum += *of_shoulders;
    return sum.norm() > 1e-6 ? Vector3d(sum.normalized()) : Vector3d::UnitX();
  }

  // from the hips to the first joint of the trunk that is not next to them
  [[nodiscard]] Vector3d lower_spine(int frame) const {
    constexpr double kNextTo = 0.1;  // of the trunk
    double trunk = 0.0;
    for (const Bone bone : {Bone::kSpine2, Bone::kNeck, Bone::kHead}) {
      if (!positions_.has(bone)) continue;
      trunk =
          std::max(trunk, (positions_.at(frame, bone) - positions_.at(frame, Bone::kHips)).norm());
    }
    for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2}) {
      if (!positions_.has(bone)) continue;
      Vector3d way = positions_.at(frame, bone) - positions_.at(frame, Bone::kHips);
      if (way.norm() > kNextTo * trunk) return way;
    }
    return positions_.trunk(frame);
  }

  void make_trunk() {
    static constexpr std::array kTrunk = {Bone::kHips,   Bone::kSpine, Bone::kSpine1,
                                          Bone::kSpine2, Bone::kNeck,  Bone::kHead};
    for (std::size_t i = 0; i < kTrunk.size(); ++i) {
      const Bone bone = kTrunk[i];
      if (!positions_.has(bone)) continue;
      std::optional<Bone> next;
      for (std::size_t j = i + 1; j < kTrunk.size() && !next; ++j) {
        if (positions_.has(kTrunk[j])) next = kTrunk[j];
      }
      for (int frame = 0; frame < frames(); ++frame) {
        const bool upper = i >= 3, lower = i == 0;
        const Vector3d line = left(frame, !upper, !lower);
        if (lower) {
          // the line across is exact here: hips turn the legs with them
          const Vector3d up = across(lower_spine(frame), line).value_or(line.unitOrthogonal());
          Matrix3d axes;
          axes << up, line.cross(up), line;
          track(bone).push_back(axes);
          continue;
        }
        const auto along = next ? positions_.way(frame, bone, *next) : std::nullopt;
        track(bone).push_back(axes_along(along.value_or(positions_.trunk(frame)), line));
      }
      // a head without anything above it turns with the neck
      if (!next && i > 0 && positions_.has(kTrunk[i - 1])) track(bone) = track(kTrunk[i - 1]);
    }
  }

  // normals of the plane in which a limb bends, upper x lower, by frame
  [[nodiscard]] std::vector<Vector3d> bend_normals(Side side, LimbBone upper, LimbBone middle,
                                                   LimbBone lower) const {
    const bool leg = middle == kLeg;
    std::vector<Vector3d> bends, uppers;
    int most = 0;
    for (int frame = 0; frame < frames(); ++frame) {
      const auto a = positions_.way(frame, side_bone(side, upper), side_bone(side, middle));
      const auto b = positions_.way(frame, side_bone(side, middle), side_bone(side, lower));
      bends.push_back(a && b ? Vector3d(a->cross(*b)) : Vector3d::Zero());
      uppers.push_back(a.value_or(Vector3d::UnitX()));
      if (bends.back().norm() > bends[static_cast<std::size_t>(most)].norm()) most = frame;
    }
    // of a straight limb: knees bend about the line across the hips, elbows about the vertical
    const auto usual = [&](int frame) {
      if (leg) return left(frame, true, false);
      return Vector3d((side == Side::kLeft ? -1.0 : 1.0) * positions_.trunk(frame));
    };
    std::vector<Vector3d> normals(bends.size());
    const auto settle = [&](int frame, const Vector3d& carried) {
      const auto f = static_cast<std::size_t>(frame);
      // elbows and knees bend one way: a little the other way is a limb that is nearly straight
      const bool overstretched = bends[f].dot(carried) < 0.0 && bends[f].norm() < kPlainBend;
      const Vector3d wanted =
          (overstretched ? -1.0 : 1.0) * bends[f] * bends[f].norm() + kBendThatCounts * carried;
      normals[f] =
          across(wanted, uppers[f])
              .value_or(across(usual(frame), uppers[f]).value_or(uppers[f].unitOrthogonal()));
    };
    if (bends.empty()) return normals;
    settle(most, usual(most));
    const auto carry = [&](int from, int to) {
      const auto f = static_cast<std::size_t>(from), t = static_cast<std::size_t>(to);
      settle(to, least_rotation(uppers[f], uppers[t], normals[f]) * normals[f]);
    };
    for (int frame = most + 1; frame < frames(); ++frame) carry(frame - 1, frame);
    for (int frame = most - 1; frame >= 0; --frame) carry(frame + 1, frame);
    return normals;
  }

  // knees and elbows bend about -Z
  void make_limb(Side side, LimbBone upper, LimbBone middle, LimbBone lower) {
    if (!positions_.has(side_bone(side, upper)) || !positions_.has(side_bone(side, middle))) return;
    const bool whole = positions_.has(side_bone(side, lower));
    const std::vector<Vector3d> normals = bend_normals(side, upper, middle, whole ? lower : middle);
    for (int frame = 0; frame < frames(); ++frame) {
      const Vector3d z = -normals[static_cast<std::size_t>(frame)];
      const auto a = positions_.way(frame, side_bone(side, upper), side_bone(side, middle));
      track(side_bone(side, upper)).push_back(axes_along(a.value_or(z.unitOrthogonal()), z));
      const auto b = whole ? positions_.way(frame, side_bone(side, middle), side_bone(side, lower))
                           : std::nullopt;
      track(side_bone(side, middle))
          .push_back(b ? axes_along(*b, z) : track(side_bone(side, upper)).back());
    }
  }

  void make_clavicle(Side side) {
    if (!positions_.has(side_bone(side, kShoulder))) return;
    const double sign = side == Side::kLeft ? 1.0 : -1.0;
    for (int frame = 0; frame < frames(); ++frame) {
      const Vector3d out = positions_.way(frame, side_bone(side, kShoulder), side_bone(side, kArm))
                               .value_or(sign * left(frame, false, true));
      track(side_bone(side, kShoulder)).push_back(axes_along(out, sign * positions_.trunk(frame)));
    }
  }

  // hands turn with forearms, feet with shins but for their direction, toes with feet
  void make_ends(Side side) {
    // a mapping file may leave out what is above: then they turn with their parents
    if (positions_.has(side_bone(side, kHand))) {
      track(side_bone(side, kHand)) = track(side_bone(side, kForeArm));
    }
    if (!positions_.has(side_bone(side, kFoot)) || track(side_bone(side, kLeg)).empty()) return;
    const Bone shin = side_bone(side, kLeg), foot = side_bone(side, kFoot);
    const Bone toe = side_bone(side, kToe);
    const Matrix3d shin_from_foot = canonical_t_pose(shin).transpose() * canonical_t_pose(foot);
    const Matrix3d foot_from_toe = canonical_t_pose(foot).transpose() * canonical_t_pose(toe);
    for (int frame = 0; frame < frames(); ++frame) {
      const Matrix3d& world_from_shin =
          track(side_bone(side, kLeg))[static_cast<std::size_t>(frame)];
      const auto ahead = positions_.way(frame, side_bone(side, kFoot), side_bone(side, kToe));
      track(side_bone(side, kFoot))
          .push_back(ahead ? axes_along(*ahead, world_from_shin.col(2))
                           : Matrix3d(world_from_shin * shin_from_foot));
      if (positions_.has(side_bone(side, kToe))) {
        track(side_bone(side, kToe))
            .push_back(track(side_bone(side, kFoot)).back() * foot_from_toe);
      }
    }
  }

  Positions positions_;
  const Body& body_;
  BoneArray<Track> tracks_;
};

// rotations of a frame's joints in the world; joints of no bone turn with their parents
std::vector<Matrix3d> world_rotations(const DirectionRotations& rotations, const Skeleton& skeleton,
                                      const std::vector<std::optional<Bone>>& bone_of_joint,
                                      int frame) {
  std::vector<Matrix3d> world(static_cast<std::size_t>(skeleton.joint_count()),
                              Matrix3d::Identity());
  for (std::size_t joint = 0; joint < world.size(); ++joint) {
    const std::optional<Bone> bone = bone_of_joint[joint];
    const int parent = skeleton.joint(static_cast<int>(joint)).parent;
    if (bone && !rotations.of(*bone).empty()) {
      world[joint] = rotations.of(*bone)[static_cast<std::size_t>(frame)];
    } else if (parent >= 0) {
      world[joint] = world[static_cast<std::size_t>(parent)];
    }
  }
  return world;
}

// the joint that turns each bone, by joint
std::vector<std::optional<Bone>> bones_by_joint(const Skeleton& skeleton, const Body& body) {
  std::vector<std::optional<Bone>> bones(static_cast<std::size_t>(skeleton.joint_count()));
  for (const Bone bone : kMappedBones) {
    const int joint = body.turning_joint(bone);
    if (joint >= 0) bones[static_cast<std::size_t>(joint)] = bone;
  }
  return bones;
}

// whether every bone that is mapped, and all joints between, have position channels
bool has_positions_of_all_bones(const Skeleton& skeleton, const BoneMap& map) {
  for (const int joint : map.joint_of_bone) {
    for (int at = joint; at > 0; at = skeleton.joint(at).parent) {
      if (skeleton.translation_slot(at) < 0) return false;
    }
  }
  return true;
}

}  // namespace

double limb_wander(const Clip& clip, const BoneMap& map) {
  if (clip.skeleton().translated_count() < 2 || clip.frame_count() == 0) return 0.0;
  const Body body(clip.skeleton(), map);
  std::array<std::vector<Vector3d>, kLimbBones.size()> directions;
  for (const int frame : sampled_frames(clip)) {
    const JointPoses pose = frame_pose(clip, frame);
    for (std::size_t i = 0; i < kLimbBones.size(); ++i) {
      const int joint = body.turning_joint(kLimbBones[i]);
      const auto way = joint < 0 ? std::nullopt : along(body.segment(kLimbBones[i]), pose);
      if (!way) continue;
      directions[i].push_back(pose[static_cast<std::size_t>(joint)].rotation.conjugate() *
                              way->normalized());
    }
  }
  std::vector<double> wander(2, 0.0);
  for (const auto& seen : directions) {
    if (seen.empty()) continue;
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& direction : seen) mean += direction / static_cast<double>(seen.size());
    // for small angles the mean of unit vectors is 1 - angle^2 / 2 long
    wander.push_back(std::sqrt(2.0 * std::max(0.0, 1.0 - mean.norm())));
  }
  std::ranges::sort(wander, std::greater());
  return wander[1];
}

void make_rotations_from_directions(Clip& clip, BoneMap& map) {
  const Body body(clip.skeleton(), map);
  const DirectionRotations rotations(clip, body);
  const auto bone_of_joint = bones_by_joint(clip.skeleton(), body);
  std::vector<Joint> joints = clip.skeleton().joints();
  for (Joint& joint : joints) {
    if (joint.parent >= 0 && joint.has_position_channels()) joint.offset.setZero();
    // nothing is known of where they are
    for (Vector3d& site : joint.end_sites) site = {site.norm(), 0.0, 0.0};
  }
  std::vector<Vector3d> translations(clip.skeleton().joint_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto world = world_rotations(rotations, clip.skeleton(), bone_of_joint, frame);
    const JointPoses& pose = rotations.positions().pose(frame);
    for (int joint = 0; joint < clip.skeleton().joint_count(); ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      const int parent = clip.skeleton().joint(joint).parent;
      const Matrix3d parent_from_world =
          parent < 0 ? Matrix3d::Identity()
                     : Matrix3d(world[static_cast<std::size_t>(parent)].transpose());
      clip.rotations(frame)[j] = Eigen::Quaterniond(parent_from_world * world[j]).normalized();
      const int slot = clip.skeleton().translation_slot(joint);
      if (slot < 0 || parent < 0) continue;
      const Vector3d translation =
          parent_from_world *
          (pose[j].translation - pose[static_cast<std::size_t>(parent)].translation);
      clip.translations(frame)[static_cast<std::size_t>(slot)] = translation;
      joints[j].offset += translation / clip.frame_count();
    }
  }
  Clip made(std::make_shared<const Skeleton>(std::move(joints)), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) copy_frame(clip, frame, made, frame);
  make_sign_continuous(made);
  clip = std::move(made);
  map.facts.rest_pose = "learned";
}

std::optional<Warning> let_directions_win(Clip& clip, BoneMap& map) {
  constexpr double kDegree = 57.295779513082321;
  constexpr double kMostWander = 3.0;  // degrees
  const double wander = kDegree * limb_wander(clip, map);
  if (wander <= kMostWander || !map.has(Bone::kHips) ||
      !has_positions_of_all_bones(clip.skeleton(), map)) {
    return std::nullopt;
  }
  make_rotations_from_directions(clip, map);
  return Warning{0, 0,
                 "the joints' rotations do not carry the limbs, which wander by " +
                     std::to_string(static_cast<int>(std::lround(wander))) +
                     " degrees against them: rotations were made from the positions; how "
                     "forearms, hands and head turn about themselves is not known"};
}

}  // namespace retarget
