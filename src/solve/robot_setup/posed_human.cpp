#include "solve/robot_setup/posed_human.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <string>

#include "retarget/human_skeleton.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "solve/robot_setup/derive_config.h"

namespace retarget {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr HumanLengths kPosedLengths;
constexpr double kRadians = std::numbers::pi / 180.0;

// Poses the bones of one side, in world axes with the origin midway between the hips.
class SidePoser {
 public:
  SidePoser(Side side, const LimbPosture& posture, HumanPose& poses)
      : side_(side), sign_(side == Side::kLeft ? 1.0 : -1.0), posture_(posture), poses_(poses) {}

  void pose_leg() {
    using enum LimbBone;
    const Quaterniond thigh = exp_so3(-posture_.thigh_ahead * Vector3d::UnitY());
    const Quaterniond shin = thigh * exp_so3(posture_.knee * Vector3d::UnitY());
    Vector3d at(kPosedLengths.hips_behind, sign_ * kPosedLengths.hip_width, 0.0);
    set(kUpLeg, thigh, at);
    at -= thigh * (kPosedLengths.thigh * Vector3d::UnitZ());
    set(kLeg, shin, at);
    at -= shin * (kPosedLengths.shin * Vector3d::UnitZ());
    for (const LimbBone foot : {kFoot, kFootMod}) set(foot, Quaterniond::Identity(), at);
    constexpr double kToesAhead = 0.14;  // Metres.
    set(kToe, Quaterniond::Identity(),
        at + Vector3d(kToesAhead, 0.0, -0.5 * kPosedLengths.ankle_height));
  }

  void pose_arm() {
    using enum LimbBone;
    // Mirroring reverses rotations about x and z.
    const Quaterniond upper = exp_so3(-sign_ * posture_.arm_ahead * Vector3d::UnitZ()) *
                              exp_so3(-sign_ * posture_.arm_down * Vector3d::UnitX()) *
                              exp_so3(-posture_.arm_twist * Vector3d::UnitY());
    const Quaterniond fore = upper * exp_so3(-sign_ * posture_.elbow * Vector3d::UnitZ());
    const Vector3d out = sign_ * Vector3d::UnitY();
    Vector3d at(0.0, sign_ * kPosedLengths.shoulder_width, kPosedLengths.shoulder_height);
    set(kShoulder, Quaterniond::Identity(), {0.0, 0.0, kPosedLengths.shoulder_height});
    set(kArm, upper, at);
    at += upper * (kPosedLengths.upper_arm * out);
    set(kForeArm, fore, at);
    at += fore * (kPosedLengths.forearm * out);
    set(kHand, fore, at);
  }

 private:
  void set(LimbBone part, const Quaterniond& turn, const Vector3d& at) {
    const Bone bone = side_bone(side_, part);
    poses_[bone] = {turn * Quaterniond(canonical_t_pose(bone)), at};
  }

  Side side_;
  double sign_;
  const LimbPosture& posture_;
  HumanPose& poses_;
};

LimbPosture between(const LimbPosture& from, const LimbPosture& to, double share) {
  const auto mix = [&](double LimbPosture::*angle) {
    return (1.0 - share) * from.*angle + share * to.*angle;
  };
  return {mix(&LimbPosture::arm_down), mix(&LimbPosture::arm_ahead),   mix(&LimbPosture::arm_twist),
          mix(&LimbPosture::elbow),    mix(&LimbPosture::thigh_ahead), mix(&LimbPosture::knee)};
}

constexpr LimbPosture degrees(double arm_down, double arm_ahead, double arm_twist, double elbow,
                              double thigh_ahead = 0.0, double knee = 0.0) {
  return {arm_down * kRadians, arm_ahead * kRadians,   arm_twist * kRadians,
          elbow * kRadians,    thigh_ahead * kRadians, knee * kRadians};
}

// Left, right; each posture is reachable from the previous one.
constexpr std::array<HumanPosture, 9> kPostures = {{
    {degrees(0, 0, 0, 0), degrees(0, 0, 0, 0)},
    {degrees(75, 0, 0, 10), degrees(75, 0, 0, 10)},
    {degrees(75, 0, 0, 80), degrees(75, 0, 0, 80)},
    {degrees(20, 70, 0, 40), degrees(20, 70, 0, 40)},
    {degrees(60, 20, 0, 30, 50, 70), degrees(75, -10, 0, 20, -10, 10)},
    {degrees(75, -10, 0, 20, -10, 10), degrees(60, 20, 0, 30, 50, 70)},
    {degrees(0, 10, 70, 80), degrees(75, 0, 0, 15)},
    {degrees(75, 0, 0, 15), degrees(0, 10, 70, 80)},
    {degrees(40, 50, 0, 60, 60, 90), degrees(40, 50, 0, 60, 60, 90)},
}};

}  // namespace

HumanPose posed_human(const HumanPosture& posture) {
  HumanPose poses;
  for (const Bone bone : kAllBones) {
    poses[bone] = {Quaterniond(canonical_t_pose(bone)), Vector3d::Zero()};
  }
  double lowest = 0.0;
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    SidePoser poser(kSides[i], posture[i], poses);
    poser.pose_leg();
    poser.pose_arm();
    const Bone foot = side_bone(kSides[i], LimbBone::kFoot);
    lowest = std::min(lowest, poses[foot].translation.z());
  }
  for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2}) {
    constexpr double kChest = 0.6;  // Fraction of the distance from hips to shoulders.
    poses[bone].translation.z() = kChest * kPosedLengths.shoulder_height;
  }
  for (const Bone bone : {Bone::kNeck, Bone::kHead}) {
    poses[bone].translation.z() = kPosedLengths.shoulder_height;
  }
  for (Pose& pose : poses) pose.translation.z() += kPosedLengths.ankle_height - lowest;
  return poses;
}

HumanClip self_test_motion(const Vector3d& forward) {
  constexpr int kSteps = 6;  // Frames between postures.
  Eigen::Matrix3d world_from_human;
  world_from_human << forward, Vector3d::UnitZ().cross(forward), Vector3d::UnitZ();
  const Pose turn{Quaterniond(world_from_human), Vector3d::Zero()};
  HumanClip clip;
  clip.rate = {10, 1};
  clip.height = clip.size = kPosedLengths.height;
  for (const Bone bone : kAllBones) clip.sources[bone] = std::string(bone_name(bone));
  for (std::size_t i = 1; i < kPostures.size(); ++i) {
    for (int step = 0; step < kSteps; ++step) {
      const double share = static_cast<double>(step) / kSteps;
      HumanPosture posture;
      for (std::size_t side = 0; side < posture.size(); ++side) {
        posture[side] = between(kPostures[i - 1][side], kPostures[i][side], share);
      }
      clip.world_from_bone.push_back(posed_human(posture));
      for (Pose& bone : clip.world_from_bone.back()) bone = turn * bone;
    }
  }
  clip.frame_count = static_cast<int>(clip.world_from_bone.size());
  return clip;
}

}  // namespace retarget
