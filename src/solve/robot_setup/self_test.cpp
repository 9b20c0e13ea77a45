#include "solve/robot_setup/self_test.h"

#include <algorithm>
#include <array>
#include <memory>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "human/skeleton/limb_segments.h"
#include "retarget/motion.h"
#include "retarget/so3.h"
#include "retarget/try.h"
#include "solve/robot_setup/describe_robot.h"
#include "solve/robot_setup/posed_human.h"
#include "solve/targets/solve_frames.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

// Returns the start points of the robot's limb bones; a segment without an end part ends along its
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

// Returns the torso's own axis, because the shoulders may be ahead of the hips: the trunk of the
// zero configuration counts as upright.
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

Result<SelfTest> run_self_test(const Robot& robot, const RobotAnatomy& limbs,
                               const ResolvedConfig& config) {
  const HumanClip human = self_test_motion(limbs.forward);
  // The clip that refers to the robot does not outlive this function.
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
