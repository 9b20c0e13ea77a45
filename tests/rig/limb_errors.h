#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/limbs.h"
#include "math/so3.h"
#include "retarget/human.h"
#include "retarget/motion.h"

namespace retarget {

/// How far a robot's limb segment points from the human's, over a motion.
struct LimbError {
  std::string segment;  ///< `left thigh`, `right forearm`, `trunk`, ...
  double mean = 0.0;    ///< Mean angle over the frames, rad.
};

using SegmentPoints = std::vector<Eigen::Vector3d>;

inline constexpr std::array<const char*, 11> kSegments = {
    "left thigh",     "left shin",    "right thigh",     "right shin",
    "left upper arm", "left forearm", "right upper arm", "right forearm",
    "trunk",          "hip line",     "shoulder line"};

// segments from the points of the limbs: left and right leg, left and right arm, each its root,
// middle and end
inline SegmentPoints segments(const std::array<std::array<Eigen::Vector3d, 3>, 4>& limbs) {
  SegmentPoints found;
  for (const auto& limb : limbs) {
    found.emplace_back(limb[1] - limb[0]);
    found.emplace_back(limb[2] - limb[1]);
  }
  found.emplace_back(limbs[2][0] + limbs[3][0] - limbs[0][0] - limbs[1][0]);
  found.emplace_back(limbs[0][0] - limbs[1][0]);
  found.emplace_back(limbs[2][0] - limbs[3][0]);
  return found;
}

inline SegmentPoints human_segments(const HumanPose& bones) {
  const auto at = [&](Side side, LimbBone part) {
    return bones[side_bone(side, part)].translation;
  };
  std::array<std::array<Eigen::Vector3d, 3>, 4> limbs;
  for (std::size_t i = 0; i < 2; ++i) {
    const Side side = kSides[i];
    limbs[i] = {at(side, LimbBone::kUpLeg), at(side, LimbBone::kLeg), at(side, LimbBone::kFoot)};
    limbs[2 + i] = {at(side, LimbBone::kArm), at(side, LimbBone::kForeArm),
                    at(side, LimbBone::kHand)};
  }
  return segments(limbs);
}

inline SegmentPoints robot_segments(const RobotAnatomy& limbs,
                                    const std::vector<Pose>& world_from_body) {
  std::array<std::array<Eigen::Vector3d, 3>, 4> points;
  for (std::size_t i = 0; i < 4; ++i) {
    const Limb& limb = i < 2 ? limbs.legs[i] : limbs.arms[i - 2];
    const auto at = [&](const LimbPart& part) {
      return world_from_body[static_cast<std::size_t>(part.body)] * part.joint;
    };
    const Pose& lower = world_from_body[static_cast<std::size_t>(limb.lower.body)];
    points[i] = {at(limb.upper), at(limb.lower),
                 limb.end ? at(*limb.end)
                          : Eigen::Vector3d(at(limb.lower) +
                                            lower.rotation * limb.lower.body_from_bone.col(0))};
  }
  return segments(points);
}

/// Angles between the segments of human and robot in the same frames: thighs, shins, upper arms,
/// forearms, trunk, hip and shoulder line; from joint positions alone, so that no offset or weight
/// of a mapping plays a part.
inline std::vector<LimbError> limb_errors(const HumanClip& human, const RobotClip& robot,
                                          const RobotAnatomy& limbs) {
  std::vector<LimbError> errors;
  for (const char* segment : kSegments) errors.push_back({segment, 0.0});
  std::vector<Pose> world_from_body(robot.robot().bodies().size());
  const int frames = std::min(human.frame_count, robot.frame_count());
  for (int frame = 0; frame < frames; ++frame) {
    forward_kinematics(robot.robot(), robot.qpos(frame), world_from_body);
    const SegmentPoints of_human = human_segments(human.frame(frame));
    const SegmentPoints of_robot = robot_segments(limbs, world_from_body);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i].mean += angle_between(of_human[i], of_robot[i]) / frames;
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
