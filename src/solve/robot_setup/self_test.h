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

/// Rotations of one arm and one leg of the canonical human away from the T-pose, rad.
struct LimbPosture {
  double arm_down = 0.0;   ///< Applied second: lowers the whole arm from the side; negative raises
                           ///< it.
  double arm_ahead = 0.0;  ///< Applied third, about the vertical: moves the arm from the side to
                           ///< the front.
  double arm_twist = 0.0;  ///< Applied first, about the arm: turns the elbow's bend from forward to
                           ///< upward.
  double elbow = 0.0;      ///< Flexion.
  double thigh_ahead = 0.0;  ///< Raises the thigh from vertical to the front.
  double knee = 0.0;         ///< Flexion.
};

/// Left, right.
using HumanPosture = std::array<LimbPosture, 2>;

/// Returns the canonical human with LAFAN1's bone lengths (HumanLengths), upright and facing along
/// x, with level feet and the lower ankle at its T-pose height above the floor.
[[nodiscard]] HumanPose posed_human(const HumanPosture& posture);

/// Returns a motion of a few seconds that covers common demands on limbs: arms hang, bend and reach
/// forward and up, legs step and squat.
/// @param forward  the human's facing direction; horizontal.
[[nodiscard]] HumanClip self_test_motion(const Eigen::Vector3d& forward);

/// Angle between a robot segment and the human segment over a motion.
struct TestedSegment {
  std::string segment;  ///< `left thigh`, `right forearm`, `trunk`, ...
  double mean = 0.0;    ///< Mean over the frames, rad.
};

/// Result of the self-test motion (self_test_motion) on a robot.
struct SelfTest {
  std::vector<TestedSegment>
      segments;       ///< In the order of kLimbSegments; without legs only those of the arms.
  double mean = 0.0;  ///< Mean over the segments, rad.
  TestedSegment worst;
};

/// Retargets the self-test motion with the two-pass method and per-limb scales, as the first stage
/// of a fit does, and measures the limbs between the identified joints.
/// Errors: those of solve_frames.
[[nodiscard]] Result<SelfTest> run_self_test(const Robot& robot, const RobotAnatomy& limbs,
                                             const ResolvedConfig& config);

/// Returns true if limb angles are too large for a faithful motion: 12 degrees on average, or 40
/// for one limb.
[[nodiscard]] bool is_fault(const SelfTest& test);

/// Returns the probable cause of a fault.
[[nodiscard]] std::string self_test_reason(const Robot& robot, const RobotAnatomy& limbs);

/// Returns a summary such as `in the self-test motion limbs are 2.3 degrees off on average, at most
/// 5.1 (left forearm)`.
[[nodiscard]] std::string self_test_text(const SelfTest& test);

}  // namespace retarget
