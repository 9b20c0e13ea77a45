#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/retargeting_config.h"
#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Rotations of an arm and a leg of the canonical human relative to the T-pose, radians. The arm's
/// rotations apply in the order arm_twist, arm_down, arm_ahead.
struct LimbPosture {
  double arm_down = 0.0;   ///< Lowers the arm from the side; a negative angle raises it.
  double arm_ahead = 0.0;  ///< Rotates the arm about the vertical, from the side to the front.
  double arm_twist = 0.0;  ///< Rotates the arm about itself, so that the elbow bends upward instead
                           ///< of forward.
  double elbow = 0.0;      ///< Flexion.
  double thigh_ahead = 0.0;  ///< Flexion of the hip: raises the thigh to the front.
  double knee = 0.0;         ///< Flexion.
};

/// Postures of the left and the right side.
using HumanPosture = std::array<LimbPosture, 2>;

/// The canonical human with LAFAN1's bone lengths (HumanLengths) in a posture: upright and facing
/// along x, with level feet and the lower ankle at its T-pose height above the floor.
[[nodiscard]] HumanPose posed_human(const HumanPosture& posture);

/// A motion of a few seconds with common limb movements: arms hang, bend and reach forward and up,
/// legs step and squat.
/// @param forward  facing direction of the human; horizontal.
[[nodiscard]] HumanClip self_test_motion(const Eigen::Vector3d& forward);

/// Angle between a segment of the robot and the same segment of the human.
struct TestedSegment {
  std::string segment;  ///< `left thigh`, `right forearm`, `trunk`, ...
  double mean = 0.0;    ///< Mean over the frames, rad.
};

/// Result of self_test_motion() on a robot.
struct SelfTest {
  /// Segments in the order of kLimbSegments; for a robot without legs, only those of the arms.
  std::vector<TestedSegment> segments;
  double mean = 0.0;    ///< Mean over the segments, rad.
  TestedSegment worst;  ///< The segment with the largest mean.
};

/// Retargets the self-test motion with the two-pass method and per-limb scales, as the first stage
/// of a fit does, and measures the limbs between the identified joints.
/// Errors: those of solve_frames.
[[nodiscard]] Result<SelfTest> run_self_test(const Robot& robot, const RobotAnatomy& limbs,
                                             const ResolvedConfig& config);

/// Whether limb angles are too large for a faithful motion: 12 degrees on average, or 40 for one
/// limb.
[[nodiscard]] bool is_fault(const SelfTest& test);

/// The probable cause of a fault.
[[nodiscard]] std::string self_test_reason(const Robot& robot, const RobotAnatomy& limbs);

/// A summary such as `in the self-test motion limbs are 2.3 degrees off on average, at most 5.1
/// (left forearm)`.
[[nodiscard]] std::string self_test_text(const SelfTest& test);

}  // namespace retarget
