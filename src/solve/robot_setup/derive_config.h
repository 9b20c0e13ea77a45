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
  double hip_width = 0.105;        ///< From the midline to a hip joint.
  double hips_behind = 0.019;      ///< From the midpoint of the hip joints back to the Hips joint.
  double shoulder_width = 0.173;   ///< From the midline to a shoulder joint.
  double shoulder_height = 0.516;  ///< From the Hips joint up to the shoulder joints.
  double ankle_height = 0.073;     ///< From the sole up to the ankle.
  double height = 1.75;
};

/// Inputs of derive_config in addition to the limbs.
struct DeriveOptions {
  double sole_height = 0.0;  ///< Height of the ankles above the soles in the T-pose, metres.
};

/// Ratio of the robot's limb lengths to the human's, before the schema's height factor.
struct DerivedScales {
  double leg = 1.0, arm = 1.0;
};
[[nodiscard]] DerivedScales derive_scales(const RobotAnatomy& limbs);

/// Derives the retargeting configuration for a robot whose limbs are known, in the schema of the
/// published tables.
///
/// Rotation offsets are canonical_bone(T)^-1 world_from_body(T) for a robot in an exact T-pose.
/// They come from the bone axes in each body (LimbPart), so that joint limits that prevent the
/// T-pose do not distort them. Position offsets point from the joint (hip, knee, ...) to the body's
/// origin and include the differences in hip width and ankle height from the scaled human. Scales
/// map a straight human leg to a straight robot leg, and arms likewise. Weights: the first pass
/// matches rotations and places the feet, the second places everything.
[[nodiscard]] RetargetingConfig derive_config(const Robot& robot, const RobotAnatomy& limbs,
                                              const DeriveOptions& options = {});

/// Formats a retargeting configuration as a file that parse_retargeting_config reads.
[[nodiscard]] std::string format_retargeting_config(const RetargetingConfig& config);

}  // namespace retarget
