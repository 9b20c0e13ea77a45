#include "solve/robot_setup/self_test.h"

#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <memory>
#include <numbers>

#include "human/skeleton/limb_segments.h"
#include "retarget/human_skeleton.h"
#include "retarget/motion.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "retarget/try.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/robot_setup/describe_robot.h"
#include "solve/targets/solve_frames.h"

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

// The postures of the motion; linear interpolation connects them.
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

// The points at which the robot's limb bones begin. A segment without a further part ends on its
// axis.
BoneArray<Vector3d> limb_points(const RobotAnatomy& limbs,
                                const std::vector<Pose>& world_from_body) {
  BoneArray<Vector3d> points{Vector3d(Vector3d::Zero())};
  const auto at = [&](const LimbPart& part) -> Vector3d {
    return world_from_body[part.body] * part.joint;
  };
  const auto add = [&](Side side, const Limb& limb, const std::array<LimbBone, 3>& bones) {
    const Pose& lower = world_from_body[limb.lower.body];
    points[side_bone(side, bones[0])] = at(limb.upper);
    points[side_bone(side, bones[1])] = at(limb.lower);
    // A body that follows the hand may rotate about a point other than the wrist.
    points[side_bone(side, bones[2])] =
        at(limb.lower) + limb.lower_length * (lower.rotation * limb.lower.body_from_bone.col(0));
  };
  for (std::size_t i = 0; i < kSides.size(); ++i) {
    using enum LimbBone;
    if (limbs.has_legs) add(kSides[i], limbs.legs[i], {kUpLeg, kLeg, kFoot});
    add(kSides[i], limbs.arms[i], {kArm, kForeArm, kHand});
  }
  return points;
}

// The axis of the torso that is vertical in the zero configuration. The line from hips to shoulders
// may lean, because the shoulders may be ahead of the hips.
Vector3d upright_of_torso(const RobotAnatomy& limbs, const std::vector<Pose>& world_from_body) {
  return world_from_body[limbs.torso].rotation * limbs.torso_from_spine2.col(0);
}

bool is_trunk(const LimbSegment& segment) {
  return segment.from[0] != segment.from[1] && segment.to[0] != segment.to[1];
}

bool is_of_arm(const LimbSegment& segment) {
  return std::ranges::all_of(segment.bones(), [](Bone bone) {
    const auto part = limb_bone(bone);
    return part == LimbBone::kArm || part == LimbBone::kForeArm || part == LimbBone::kHand;
  });
}

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

Result<SelfTest> run_self_test(const Robot& robot, const RobotAnatomy& limbs,
                               const ResolvedConfig& config) {
  const HumanClip human = self_test_motion(limbs.forward);
  // A pointer without ownership suffices, because the clip does not outlive this function.
  const std::shared_ptr<const Robot> shared(std::shared_ptr<const Robot>(), &robot);
  SolveFramesOptions options;
  options.scale = ScaleRule::kLimbs;
  options.trunk = TrunkRule::kLines;
  options.settle = true;
  RETARGET_TRY_ASSIGN(const SolvedFrames solved,
                      solve_frames(human, shared, config, robot.model_limits(), options));
  SelfTest test;
  std::vector<Pose> world_from_body(robot.bodies().size());
  std::array<double, kLimbSegments.size()> sums{};
  for (int frame = 0; frame < solved.clip.frame_count(); ++frame) {
    forward_kinematics(robot, solved.clip.qpos(frame), world_from_body);
    const auto points = limb_points(limbs, world_from_body);
    const HumanPose& bones = human.frame(frame);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const LimbSegment& segment = kLimbSegments[i];
      const Vector3d wanted = segment.direction([&](Bone bone) { return bones[bone].translation; });
      const Vector3d found = is_trunk(segment)
                                 ? upright_of_torso(limbs, world_from_body)
                                 : segment.direction([&](Bone bone) { return points[bone]; });
      sums[i] += angle_between(wanted, found);
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (!limbs.has_legs && !is_of_arm(kLimbSegments[i])) continue;
    test.segments.push_back({kLimbSegments[i].name, sums[i] / solved.clip.frame_count()});
  }
  for (const TestedSegment& segment : test.segments) {
    test.mean += segment.mean / static_cast<double>(test.segments.size());
    if (segment.mean > test.worst.mean) test.worst = segment;
  }
  return test;
}

bool is_fault(const SelfTest& test) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  constexpr double kMean = 12.0 * kDegree, kWorst = 40.0 * kDegree;
  return test.mean > kMean || test.worst.mean > kWorst;
}

std::string self_test_reason(const Robot& robot, const RobotAnatomy& limbs) {
  constexpr int kWholeShoulder = 3;
  const auto name = [&](const Limb& limb) {
    return "\"" + robot.joints()[limb.joints[limb.middle]].name + "\"";
  };
  if (limbs.arms[0].middle < kWholeShoulder) {
    return fmt::format(
        "its shoulders have {} joints, so its upper arms cannot rotate about their axes and its "
        "elbows bend to one side only",
        limbs.arms[0].middle);
  }
  return fmt::format("check that {}{} is its elbow, and the ranges of its joints",
                     limbs.has_legs ? name(limbs.legs[0]) + " is its knee and " : "",
                     name(limbs.arms[0]));
}

std::string self_test_text(const SelfTest& test) {
  return fmt::format("in the self-test motion limbs are {} degrees off on average, at most {} ({})",
                     degrees_text(test.mean), degrees_text(test.worst.mean), test.worst.segment);
}

}  // namespace retarget
