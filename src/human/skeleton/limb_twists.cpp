#include "human/skeleton/limb_directions.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "human/skeleton/learned_axes.h"
#include "human/skeleton/limb_segments.h"
#include "human/skeleton/posed_body.h"
#include "retarget/clip_range.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "retarget/trigonometry.h"

namespace retarget {
namespace {

using enum LimbBone;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Deviation of the normal of a limb's bend in a bone, rad: root mean square, weighted by the sine of
// the bend. 0 if the limb hardly bends.
double hinge_wander(const Body& body, const std::vector<JointPoses>& poses, const LimbBones& limb,
                    Bone bone) {
  constexpr double kMinBendOfHinge = 0.35;  // Root mean square of the sine.
  std::vector<Vector3d> normals;
  Vector3d sum = Vector3d::Zero();
  double weights = 0.0;
  for (const JointPoses& pose : poses) {
    const auto upper = along(body.segment(limb.upper), pose);
    const auto lower = along(body.segment(limb.lower), pose);
    if (!upper || !lower) continue;
    const Vector3d normal = pose[body.turning_joint(bone)].rotation.conjugate() *
                            upper->normalized().cross(lower->normalized());
    normals.push_back(normal);
    sum += normal.norm() * normal;
    weights += normal.squaredNorm();
  }
  if (weights < kMinBendOfHinge * kMinBendOfHinge * static_cast<double>(normals.size())) return 0.0;
  double squares = 0.0;
  for (const Vector3d& normal : normals) {
    const double angle = angle_between(normal, sum);
    squares += normal.squaredNorm() * angle * angle;
  }
  return weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
}

// The smaller deviation of a limb's two bones, rad; 0 if bones are missing.
double limb_wander_about_hinge(const Body& body, const std::vector<JointPoses>& poses,
                               const LimbBones& limb) {
  if (body.turning_joint(limb.upper) < 0 || body.turning_joint(limb.lower) < 0) return 0.0;
  return std::min(hinge_wander(body, poses, limb, limb.upper),
                  hinge_wander(body, poses, limb, limb.lower));
}

// Computes the twists of limbs from the planes of their bends, frame by frame.
class Twister {
 public:
  Twister(Clip& clip, const Body& body, const Calibration& calibration)
      : clip_(clip),
        body_(body),
        calibration_(calibration),
        tracks_(rotations_from_directions(clip, body, StraightLimbs::kTurnWithTrunk)) {}

  void turn(const LimbBones& limb) {
    for (int frame = 0; frame < clip_.frame_count(); ++frame) {
      const JointPoses pose = frame_pose(clip_, frame);
      const Quaterniond of_upper = twist(limb.upper, pose, frame);
      const Quaterniond of_lower = twist(limb.lower, pose, frame);
      set(limb.upper, pose, frame, Quaterniond::Identity(), of_upper);
      set(limb.lower, pose, frame, of_upper, of_lower);
      set(limb.end, pose, frame, of_lower, Quaterniond::Identity());
    }
  }

 private:
  // World rotation about the bone from the calibrated Z to the Z of the bend.
  [[nodiscard]] Quaterniond twist(Bone bone, const JointPoses& pose, int frame) const {
    const auto way = along(body_.segment(bone), pose);
    const auto& joint_from_bone = calibration_.bones[bone].joint_from_bone;
    if (!way || tracks_[bone].empty()) return Quaterniond::Identity();
    Quaterniond world_from_bone = pose[body_.turning_joint(bone)].rotation;
    if (joint_from_bone) world_from_bone = world_from_bone * *joint_from_bone;
    const Vector3d x = way->normalized();
    const Vector3d now = world_from_bone * Vector3d::UnitZ();
    const Vector3d normal = -tracks_[bone][static_cast<std::size_t>(frame)].col(2);
    const Vector3d wanted = canonical_z(bone, x, normal);
    return exp_so3(
        portable::atan2(x.dot(now.cross(wanted)), now.dot(wanted) - x.dot(now) * x.dot(wanted)) *
        x);
  }

  // Applies a world rotation to the joint at the start of a bone. Its parent has been rotated too.
  void set(Bone bone, const JointPoses& pose, int frame, const Quaterniond& of_parent,
           const Quaterniond& turn) {
    const int joint = body_.joint(bone);
    if (joint < 0) return;
    const int parent = body_.skeleton().joint(joint).parent;
    const Quaterniond above =
        parent < 0 ? of_parent : Quaterniond(of_parent * pose[parent].rotation);
    clip_.rotations(frame)[joint] = (above.conjugate() * turn * pose[joint].rotation).normalized();
  }

  Clip& clip_;
  const Body& body_;
  const Calibration& calibration_;
  BoneArray<std::vector<Eigen::Matrix3d>> tracks_;
};

}  // namespace

std::optional<Warning> let_bends_win(Clip& clip, const BoneMap& map,
                                     const Calibration& calibration) {
  constexpr double kDegreesPerRad = 57.295779513082321;
  constexpr double kMaxWander = 20.0;  // degrees
  constexpr std::size_t kMinPosesOfBends = 5;
  // The published method uses LAFAN1's rotations unchanged.
  if (calibration.rest_pose.starts_with("lafan1") || clip.frame_count() == 0) return std::nullopt;
  const auto skeleton = clip.shared_skeleton();
  const Body body(*skeleton, map);
  std::vector<JointPoses> poses;
  for (const int frame : sampled_frames(clip, count_lead_in_frames(clip))) {
    poses.push_back(frame_pose(clip, frame));
  }
  if (poses.size() < kMinPosesOfBends) return std::nullopt;
  std::vector<std::string> names;
  std::vector<LimbBones> limbs;
  double largest = 0.0;
  for (const LimbBones& limb : kLimbs) {
    const double wander = kDegreesPerRad * limb_wander_about_hinge(body, poses, limb);
    if (wander <= kMaxWander) continue;
    largest = std::max(largest, wander);
    names.emplace_back(limb.name);
    limbs.push_back(limb);
  }
  if (limbs.empty()) return std::nullopt;
  Twister twister(clip, body, calibration);
  for (const LimbBones& limb : limbs) twister.turn(limb);
  make_sign_continuous(clip);
  return Warning{0, 0,
                 fmt::format("knees and elbows do not bend about fixed axes in {}: rotations are "
                             "off by {} degrees about the bones, and were computed from the planes "
                             "in which the limbs bend",
                             list_names(names), std::lround(largest))};
}

}  // namespace retarget
