#pragma once

#include <utility>
#include <vector>

#include "judge/quality/limb_directions.h"
#include "judge/quality/report_parts.h"
#include "retarget/robot.h"

namespace retarget {

/// A hinge joint and its constant angular offset.
struct JointOffset {
  int joint = 0;        ///< Index into Robot::joints().
  double offset = 0.0;  ///< Radians; subtracting it brings the limbs closest to the human's.
};

/// Estimates the constant offset of each hinge joint. A small rotation d of joint j alone, in every
/// frame, changes the unit vectors u along the first limbs that the joint moves (the trunk, else
/// the upper arm, else the forearm) by d u_j. The offset is the negative of the rotation that
/// brings u closest to the human's unit vectors w in the least-squares sense:
///   offset_j = -(sum of u_j . (w - u)) / (sum of u_j . u_j)
/// The sums are over the limbs that are free (LimbDirections::free) and the frames in which the
/// joint is not at a limit. Omits joints that hardly move these limbs, such as those that twist a
/// limb about its axis.
[[nodiscard]] std::vector<JointOffset> find_joint_offsets(const RobotClip& clip,
                                                          const LimitSet& limits,
                                                          const std::vector<LimbDirections>& limbs);

/// Penalty of each offset, radians: its absolute value. If the corresponding joint of the other arm
/// also has an offset, the penalty is the difference of the absolute values, but at least half of
/// its own, because a broad body offsets both arms equally.
/// @param pairs  corresponding joints of the left and the right arm.
[[nodiscard]] std::vector<double> weigh_offsets(const std::vector<JointOffset>& offsets,
                                                const std::vector<std::pair<int, int>>& pairs);

/// Measures `joint_offset_rad`, the largest penalty (weigh_offsets()).
/// @param limbs  limbs without the legs, which must reach the floor with other lengths than the
///     human's.
/// @param hands  axes of the hands, for joints that the limbs do not determine.
void measure_joint_offsets(const ReportBuilder& draft, const LimitSet& limits,
                           const std::vector<LimbDirections>& limbs,
                           const std::vector<LimbDirections>& hands);

}  // namespace retarget
