#pragma once

#include <string>

#include "anatomy/limbs.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "rig/t_pose.h"

namespace retarget {

/// Bone lengths of the canonical human (LAFAN1's skeleton, 1.75 m), metres.
struct HumanLengths {
  double thigh = 0.435, shin = 0.424;
  double upper_arm = 0.330, forearm = 0.252;
  double hip_width = 0.105;        ///< From the middle to a hip joint.
  double hips_behind = 0.019;      ///< From the middle of the hip joints back to the Hips joint.
  double shoulder_width = 0.173;   ///< From the middle to a shoulder joint.
  double shoulder_height = 0.516;  ///< From the Hips joint up to the shoulder joints.
  double ankle_height = 0.073;     ///< From the sole up to the ankle.
  double height = 1.75;
};

/// What a retargeting configuration is derived from beside the limbs.
struct DeriveOptions {
  double sole_height = 0.0;  ///< From the soles up to the ankles in the T-pose, metres.
};

/// How long the robot's parts are against the human's: scales before the schema's height factor.
struct DerivedScales {
  double leg = 1.0, arm = 1.0;
};
[[nodiscard]] DerivedScales derive_scales(const RobotAnatomy& limbs);

/// The configuration for a robot whose limbs are known, in the schema of the published tables.
///
/// Rotation offsets are canonical_bone(T)^-1 world_from_body(T) with the robot in an exact T-pose,
/// body by body: what the bone's axes in the body (LimbPart) say, so that joint limits which keep
/// a robot from the pose do not spoil them. Position offsets lead from the joint (hip, knee, ...)
/// to the body's origin, and take up that the robot's hips are wider and its ankles higher or lower
/// than the scaled human's. Scales: a straight human leg is a straight robot leg; arms likewise.
/// Weights: the first pass turns everything and places the feet, the second places all.
[[nodiscard]] RetargetingConfig derive_config(const Robot& robot, const RobotAnatomy& limbs,
                                              const DeriveOptions& options = {});

/// A retargeting configuration as the text of a file, in the schema that parse_retargeting_config reads.
[[nodiscard]] std::string format_retargeting_config(const RetargetingConfig& config);

}  // namespace retarget
