#pragma once

#include <array>
#include <string>
#include <vector>

#include "human/skeleton/limb_segments.h"
#include "retarget/human.h"
#include "retarget/motion.h"
#include "retarget/so3.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Angle between a robot's and the human's limb segment, over a motion.
struct LimbError {
  std::string segment;  ///< `left thigh`, `right forearm`, `trunk`, ...
  double mean = 0.0;    ///< Mean angle over the frames, rad.
};

/// Start points of the bones of a robot's limbs; a shin or forearm without an end ends along its
/// axis.
inline BoneArray<Eigen::Vector3d> limb_points(const RobotAnatomy& limbs,
                                              const std::vector<Pose>& world_from_body) {
  BoneArray<Eigen::Vector3d> points;
  const auto at = [&](const LimbPart& part) {
    return world_from_body[static_cast<std::size_t>(part.body)] * part.joint;
  };
  const auto add = [&](Side side, const Limb& limb, const std::array<LimbBone, 3>& bones) {
    const Pose& lower = world_from_body[static_cast<std::size_t>(limb.lower.body)];
    points[side_bone(side, bones[0])] = at(limb.upper);
    points[side_bone(side, bones[1])] = at(limb.lower);
    points[side_bone(side, bones[2])] =
        limb.end
            ? at(*limb.end)
            : Eigen::Vector3d(at(limb.lower) + lower.rotation * limb.lower.body_from_bone.col(0));
  };
  for (std::size_t i = 0; i < 2; ++i) {
    add(kSides[i], limbs.legs[i], {LimbBone::kUpLeg, LimbBone::kLeg, LimbBone::kFoot});
    add(kSides[i], limbs.arms[i], {LimbBone::kArm, LimbBone::kForeArm, LimbBone::kHand});
  }
  return points;
}

/// Angles between the segments of human and robot in the same frames: thighs, shins, upper arms,
/// forearms, trunk, hip and shoulder line; only from joint positions, independent of offsets and
/// weights of a retargeting configuration.
inline std::vector<LimbError> limb_errors(const HumanClip& human, const RobotClip& robot,
                                          const RobotAnatomy& limbs) {
  std::vector<LimbError> errors;
  for (const LimbSegment& segment : kLimbSegments) errors.push_back({segment.name, 0.0});
  std::vector<Pose> world_from_body(robot.robot().bodies().size());
  const int frames = std::min(human.frame_count, robot.frame_count());
  for (int frame = 0; frame < frames; ++frame) {
    forward_kinematics(robot.robot(), robot.qpos(frame), world_from_body);
    const auto points = limb_points(limbs, world_from_body);
    const HumanPose& bones = human.frame(frame);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const LimbSegment& segment = kLimbSegments[i];
      errors[i].mean +=
          angle_between(segment.direction([&](Bone bone) { return bones[bone].translation; }),
                        segment.direction([&](Bone bone) { return points[bone]; })) /
          frames;
    }
  }
  return errors;
}

/// Mean over the segments, rad.
inline double mean_limb_error(const std::vector<LimbError>& errors) {
  double sum = 0.0;
  for (const LimbError& error : errors) sum += error.mean;
  return errors.empty() ? 0.0 : sum / static_cast<double>(errors.size());
}

}  // namespace retarget
