#pragma once

#include <string>

#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"
#include "solve/robot_setup/t_pose.h"

namespace retarget {

/// Bone lengths of the canonical human (LAFAN1's skeleton, 1.75 m), metres.
struct HumanLengths {
  double thigh = 0.435, shin = 0.424;
  double upper_arm = 0.330, forearm = 0.252;
  double hip_width = 0.105;    ///< Lateral distance of a hip joint from the midline.
  double hips_behind = 0.019;  ///< Distance of the Hips joint behind the middle of the hip joints.
  double shoulder_width = 0.173;   ///< Lateral distance of a shoulder joint from the midline.
  double shoulder_height = 0.516;  ///< Height of the shoulder joints above the Hips joint.
  double ankle_height = 0.073;     ///< Height of the ankle above the sole.
  double height = 1.75;            ///< Height of the body.
};

/// Further inputs of derive_config().
struct DeriveOptions {
  double sole_height = 0.0;  ///< Height of the ankles above the soles in the T-pose, metres.
};

/// Ratios of the robot's limb lengths to the human's, before the factor for the human's height that
/// the schema prescribes.
struct DerivedScales {
  double leg = 1.0, arm = 1.0;
};
/// Computes the ratios for a robot.
[[nodiscard]] DerivedScales derive_scales(const RobotAnatomy& limbs);

/// Derives the retargeting configuration for a robot whose limbs are known, in the schema of the
/// published tables.
///
/// Rotation offsets are canonical_bone(T)^-1 world_from_body(T) for a robot in an exact T-pose.
/// They come from the bone axes in each body (LimbPart), so that joint limits that prevent the
/// T-pose do not distort them. Position offsets point from the joint (hip, knee, ...) to the body's
/// origin and include the differences in hip width and ankle height from the scaled human. Scales
/// map a straight human leg to a straight robot leg, and arms likewise. The first pass weights
/// rotations and the positions of the feet, the second pass all positions.
[[nodiscard]] RetargetingConfig derive_config(const Robot& robot, const RobotAnatomy& limbs,
                                              const DeriveOptions& options = {});

/// Formats a retargeting configuration as JSON for parse_retargeting_config().
[[nodiscard]] std::string format_retargeting_config(const RetargetingConfig& config);

}  // namespace retarget
