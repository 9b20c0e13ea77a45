#include "human/skeleton/limb_directions.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "human/skeleton/skeleton_tree.h"
#include "retarget/options.h"

namespace retarget {
namespace {

using enum LimbBone;

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::array kLimbBones = {Bone::kLeftUpLeg,   Bone::kLeftLeg,     Bone::kLeftArm,
                                   Bone::kLeftForeArm, Bone::kRightUpLeg,  Bone::kRightLeg,
                                   Bone::kRightArm,    Bone::kRightForeArm};

// Squared sine of a bend at which its plane weighs as much as that of the previous frame.
constexpr double kBendThatCounts = 0.01;
// Weight of the foot's direction in the bending plane of its knee, on the same scale.
constexpr double kFootThatCounts = 0.12;
// Sine of a bend that alone determines which way the limb bends.
constexpr double kPlainBend = 0.35;

// Component of a vector orthogonal to a unit vector, normalised; nothing if it vanishes.
std::optional<Vector3d> across(const Vector3d& vector, const Vector3d& unit) {
  const Vector3d rest = vector - vector.dot(unit) * unit;
  if (!(rest.norm() > 1e-6 * vector.norm())) return std::nullopt;
  return Vector3d(rest.normalized());
}

// Axes with an exact X and a Z as close as possible.
Matrix3d axes_along(const Vector3d& x, const Vector3d& z) {
  Matrix3d axes;
  axes.col(0) = x;
  axes.col(2) = across(z, x).value_or(x.unitOrthogonal());
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// World rotations of one bone, by frame.
using TurnTrack = std::vector<Matrix3d>;

// Rotations of mapped bones in all frames, from the positions of their joints.
class DirectionRotations {
 public:
  DirectionRotations(const Clip& clip, const Body& body, StraightLimbs straight)
      : body_(body), straight_(straight) {
    for (int frame = 0; frame < clip.frame_count(); ++frame) {
      poses_.push_back(frame_pose(clip, frame));
    }
    make_trunk();
    for (const Side side : kSides) {
      make_limb(side, kUpLeg, kLeg, kFoot);
      make_limb(side, kArm, kForeArm, kHand);
      make_clavicle(side);
      make_ends(side);
    }
  }

  // Empty: the bone is not mapped.
  [[nodiscard]] const TurnTrack& of(Bone bone) const { return tracks_[bone]; }
  [[nodiscard]] const BoneArray<TurnTrack>& tracks() const { return tracks_; }
  [[nodiscard]] const JointPoses& pose(int frame) const { return poses_[frame]; }

 private:
  [[nodiscard]] int frames() const { return static_cast<int>(poses_.size()); }
  [[nodiscard]] bool has(Bone bone) const { return body_.has(bone); }

  [[nodiscard]] Vector3d line(int frame, Bone from, Bone to) const {
    return poses_[frame][body_.joint(to)].translation -
           poses_[frame][body_.joint(from)].translation;
  }
  // Unit vector from one bone's joint to another's.
  [[nodiscard]] std::optional<Vector3d> way(int frame, Bone from, Bone to) const {
    if (!has(from) || !has(to)) return std::nullopt;
    const Vector3d found = line(frame, from, to);
    if (!(found.norm() > 1e-9)) return std::nullopt;
    return Vector3d(found.normalized());
  }
  [[nodiscard]] Vector3d trunk(int frame) const {
    return trunk_direction(body_, poses_[frame]).value_or(Vector3d::UnitY());
  }

  // Line across the hips, the shoulders, or both; uses the other one if one is missing.
  [[nodiscard]] Vector3d left(int frame, bool hips, bool shoulders) const {
    const auto of_hips = way(frame, Bone::kRightUpLeg, Bone::kLeftUpLeg);
    const auto of_shoulders = way(frame, Bone::kRightArm, Bone::kLeftArm);
    Vector3d sum = Vector3d::Zero();
    if (of_hips && (hips || !of_shoulders)) sum += *of_hips;
    if (of_shoulders && (shoulders || !of_hips)) sum += *of_shoulders;
    return sum.norm() > 1e-6 ? Vector3d(sum.normalized()) : Vector3d::UnitX();
  }

  // From the hips to the first trunk joint that is not close to them.
  [[nodiscard]] Vector3d lower_spine(int frame) const {
    constexpr double kNextTo = 0.1;  // Share of the trunk.
    double length = 0.0;
    for (const Bone bone : {Bone::kSpine2, Bone::kNeck, Bone::kHead}) {
      if (has(bone)) length = std::max(length, line(frame, Bone::kHips, bone).norm());
    }
    for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2}) {
      if (!has(bone)) continue;
      Vector3d found = line(frame, Bone::kHips, bone);
      if (found.norm() > kNextTo * length) return found;
    }
    return trunk(frame);
  }

  void make_trunk() {
    std::vector<Bone> bones = trunk_bones();
    std::erase_if(bones, [this](Bone bone) { return !has(bone); });
    for (std::size_t i = 0; i < bones.size(); ++i) {
      const bool lowest = bones[i] == Bone::kHips, last = i + 1 == bones.size();
      // A head without a bone above it turns with the neck.
      if (last && i > 0 && bones[i - 1] == *(std::ranges::find(trunk_bones(), bones[i]) - 1)) {
        tracks_[bones[i]] = tracks_[bones[i - 1]];
        continue;
      }
      for (int frame = 0; frame < frames(); ++frame) {
        const Vector3d across_body = left(frame, bones[i] < Bone::kSpine2, !lowest);
        if (!lowest) {
          const auto along = last ? std::nullopt : way(frame, bones[i], bones[i + 1]);
          tracks_[bones[i]].push_back(axes_along(along.value_or(trunk(frame)), across_body));
          continue;
        }
        // The line across the hips is exact here, because hips turn the legs with them.
        const Vector3d up =
            across(lower_spine(frame), across_body).value_or(across_body.unitOrthogonal());
        Matrix3d axes;
        axes << up, across_body.cross(up), across_body;
        tracks_[bones[i]].push_back(axes);
      }
    }
  }

  // Normal of the plane of shin and foot, to the left; small if they are aligned. A knee does not
  // turn the foot sideways, while hip, knee and ankle never lie exactly in the plane of a small
  // bend.
  [[nodiscard]] Vector3d across_foot(int frame, Side side, Bone middle) const {
    if (straight_ == StraightLimbs::kStay || limb_bone(middle) != kLeg) return Vector3d::Zero();
    const Bone foot = side_bone(side, kFoot);
    const auto shin = way(frame, middle, foot), ahead = way(frame, foot, side_bone(side, kToe));
    if (!shin || !ahead) return Vector3d::Zero();
    return kFootThatCounts * ahead->cross(*shin);
  }

  // Normals of the plane in which a limb bends, upper x lower, by frame.
  [[nodiscard]] std::vector<Vector3d> bend_normals(Side side, Bone upper, Bone middle,
                                                   Bone lower) const {
    std::vector<Vector3d> bends, uppers;
    int peak = 0;
    for (int frame = 0; frame < frames(); ++frame) {
      const auto a = way(frame, upper, middle), b = way(frame, middle, lower);
      bends.push_back(a && b ? Vector3d(a->cross(*b)) : Vector3d::Zero());
      uppers.push_back(a.value_or(Vector3d::UnitX()));
      if (bends.back().norm() > bends[peak].norm()) peak = frame;
    }
    // Default normal of a straight limb: knees bend about the hip line, elbows about the vertical.
    const auto usual = [&](int frame) {
      if (limb_bone(middle) == kLeg) return left(frame, true, false);
      return Vector3d((side == Side::kLeft ? -1.0 : 1.0) * trunk(frame));
    };
    std::vector<Vector3d> normals(bends.size());
    const auto settle = [&](int frame, const Vector3d& carried) {
      const Vector3d &bend = bends[frame], &along = uppers[frame];
      const Vector3d expected = kBendThatCounts * carried + across_foot(frame, side, middle);
      // Elbows and knees bend one way: a small bend the other way is a nearly straight limb.
      const bool overstretched = bend.dot(expected) < 0.0 && bend.norm() < kPlainBend;
      const Vector3d wanted = (overstretched ? -1.0 : 1.0) * bend * bend.norm() + expected;
      normals[frame] = across(wanted, along)
                           .value_or(across(usual(frame), along).value_or(along.unitOrthogonal()));
    };
    if (bends.empty()) return normals;
    settle(peak, usual(peak));
    const TurnTrack& trunk_of_limb =
        tracks_[limb_bone(middle) == kLeg || !has(Bone::kSpine2) ? Bone::kHips : Bone::kSpine2];
    const bool with_trunk = straight_ == StraightLimbs::kTurnWithTrunk && !trunk_of_limb.empty();
    const auto seen = [&](int frame) {
      return with_trunk ? Matrix3d(trunk_of_limb[frame].transpose())
                        : Matrix3d(Matrix3d::Identity());
    };
    const auto carry = [&](int from, int to) {
      const Matrix3d before = seen(from), now = seen(to);
      const Vector3d a = before * uppers[from], b = now * uppers[to], n = before * normals[from];
      settle(to, now.transpose() * (minimal_rotation(a, b, n) * n));
    };
    for (int frame = peak + 1; frame < frames(); ++frame) carry(frame - 1, frame);
    for (int frame = peak - 1; frame >= 0; --frame) carry(frame + 1, frame);
    return normals;
  }

  // Knees and elbows bend about -Z.
  void make_limb(Side side, LimbBone upper_part, LimbBone middle_part, LimbBone end_part) {
    const Bone upper = side_bone(side, upper_part), middle = side_bone(side, middle_part);
    const Bone end = side_bone(side, end_part);
    if (!has(upper) || !has(middle)) return;
    const std::vector<Vector3d> normals =
        bend_normals(side, upper, middle, has(end) ? end : middle);
    for (int frame = 0; frame < frames(); ++frame) {
      const Vector3d z = -normals[frame];
      const auto a = way(frame, upper, middle), b = way(frame, middle, end);
      tracks_[upper].push_back(axes_along(a.value_or(z.unitOrthogonal()), z));
      tracks_[middle].push_back(b ? axes_along(*b, z) : tracks_[upper].back());
    }
  }

  void make_clavicle(Side side) {
    const Bone clavicle = side_bone(side, kShoulder), arm = side_bone(side, kArm);
    if (!has(clavicle)) return;
    const double sign = side == Side::kLeft ? 1.0 : -1.0;
    for (int frame = 0; frame < frames(); ++frame) {
      const Vector3d out = way(frame, clavicle, arm).value_or(sign * left(frame, false, true));
      tracks_[clavicle].push_back(axes_along(out, sign * trunk(frame)));
    }
  }

  // Hands turn with forearms. Feet turn with shins except for their direction, toes with feet.
  void make_ends(Side side) {
    const Bone shin = side_bone(side, kLeg), foot = side_bone(side, kFoot);
    const Bone toe = side_bone(side, kToe), hand = side_bone(side, kHand);
    // A bone map may omit the bones above; then hands and feet turn with their parents.
    if (has(hand)) tracks_[hand] = tracks_[side_bone(side, kForeArm)];
    if (!has(foot) || tracks_[shin].empty()) return;
    const Matrix3d shin_from_foot = canonical_t_pose(shin).transpose() * canonical_t_pose(foot);
    const Matrix3d foot_from_toe = canonical_t_pose(foot).transpose() * canonical_t_pose(toe);
    for (int frame = 0; frame < frames(); ++frame) {
      const Matrix3d& world_from_shin = tracks_[shin][frame];
      const auto ahead = way(frame, foot, toe);
      tracks_[foot].push_back(ahead ? axes_along(*ahead, world_from_shin.col(2))
                                    : Matrix3d(world_from_shin * shin_from_foot));
      if (has(toe)) tracks_[toe].push_back(tracks_[foot].back() * foot_from_toe);
    }
  }

  const Body& body_;
  StraightLimbs straight_;
  std::vector<JointPoses> poses_;
  BoneArray<TurnTrack> tracks_;
};

// Tracks of the joints that turn bones, by joint; null: the joint turns with its parent.
std::vector<const TurnTrack*> tracks_by_joint(const DirectionRotations& rotations,
                                              const Skeleton& skeleton, const Body& body) {
  std::vector<const TurnTrack*> tracks(skeleton.joint_count());
  for (const Bone bone : kMappedBones) {
    const int joint = body.turning_joint(bone);
    if (joint >= 0) tracks[joint] = rotations.of(bone).empty() ? nullptr : &rotations.of(bone);
  }
  return tracks;
}

// Whether every mapped bone, and all joints between them, have position channels.
bool has_positions_of_all_bones(const Skeleton& skeleton, const BoneMap& map) {
  for (const int joint : map.joint_of_bone) {
    for (int at = joint; at > 0; at = skeleton.joint(at).parent) {
      if (skeleton.translation_slot(at) < 0) return false;
    }
  }
  return true;
}

// Wander of the limbs as documented in the header, in radians. Returns 0 if only the root is
// translated: positions then follow from the rotations.
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
      directions[i].push_back(pose[joint].rotation.conjugate() * way->normalized());
    }
  }
  std::vector<double> wander(2, 0.0);
  for (const auto& seen : directions) {
    if (seen.empty()) continue;
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& direction : seen) mean += direction / static_cast<double>(seen.size());
    // For small angles, the mean of unit vectors has the length 1 - angle^2 / 2.
    wander.push_back(std::sqrt(2.0 * std::max(0.0, 1.0 - mean.norm())));
  }
  std::ranges::sort(wander, std::greater());
  return wander[1];
}

}  // namespace

BoneArray<std::vector<Matrix3d>> rotations_from_directions(const Clip& clip, const Body& body,
                                                           StraightLimbs straight) {
  return DirectionRotations(clip, body, straight).tracks();
}

void make_rotations_from_directions(Clip& clip, BoneMap& map, StraightLimbs straight) {
  const Skeleton& skeleton = clip.skeleton();
  const Body body(skeleton, map);
  const DirectionRotations rotations(clip, body, straight);
  const std::vector<const TurnTrack*> tracks = tracks_by_joint(rotations, skeleton, body);
  std::vector<Joint> joints = skeleton.joints();
  for (Joint& joint : joints) {
    if (joint.parent >= 0 && joint.has_position_channels()) joint.offset.setZero();
    // Their directions are unknown.
    for (Vector3d& site : joint.end_sites) site = {site.norm(), 0.0, 0.0};
  }
  std::vector<Matrix3d> world(joints.size());
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const JointPoses& pose = rotations.pose(frame);
    for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
      const int parent = joints[joint].parent;
      const Matrix3d world_from_parent =
          parent < 0 ? Matrix3d(Matrix3d::Identity()) : world[parent];
      world[joint] = tracks[joint] != nullptr ? (*tracks[joint])[frame] : world_from_parent;
      clip.rotations(frame)[joint] =
          Eigen::Quaterniond(world_from_parent.transpose() * world[joint]).normalized();
      const int slot = skeleton.translation_slot(joint);
      if (slot < 0 || parent < 0) continue;
      const Vector3d translation =
          world_from_parent.transpose() * (pose[joint].translation - pose[parent].translation);
      clip.translations(frame)[slot] = translation;
      joints[joint].offset += translation / clip.frame_count();
    }
  }
  Clip made(std::make_shared<const Skeleton>(std::move(joints)), clip.rate(), clip.frame_count());
  for (int frame = 0; frame < clip.frame_count(); ++frame) copy_frame(clip, frame, made, frame);
  make_sign_continuous(made);
  made.set_origin(clip.origin());
  clip = std::move(made);
  map.facts.rest = RestPose::kLearned;
}

std::optional<Warning> let_directions_win(Clip& clip, BoneMap& map) {
  constexpr double kDegree = 57.295779513082321;
  constexpr double kMaxWander = 3.0;  // degrees
  const double wander = kDegree * limb_wander(clip, map);
  if (wander <= kMaxWander || !map.has(Bone::kHips) ||
      !has_positions_of_all_bones(clip.skeleton(), map)) {
    return std::nullopt;
  }
  make_rotations_from_directions(clip, map, StraightLimbs::kStay);
  return Warning{
      0, 0,
      fmt::format("the joints' rotations do not match the limbs, which are off by up to {} "
                  "degrees: rotations were computed from the positions; the twist of forearms, "
                  "hands and head is unknown",
                  std::lround(wander))};
}

}  // namespace retarget
