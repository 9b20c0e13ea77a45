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
  double offset = 0.0;  ///< Rad; subtracting it brings the limbs nearest to the human's.
};

/// Estimates the constant offset of each hinge joint. Turning joint j alone by a small angle d in
/// every frame moves the unit vectors u along the first limbs that it moves (the trunk, else the
/// upper arm, else the forearm) by d u_j. The offset is the negative of the angle that brings them
/// closest to the human's unit vectors w in the least-squares sense:
///   offset_j = -(sum of u_j . (w - u)) / (sum of u_j . u_j)
/// over the free limbs and all frames in which the joint is not at a limit. Joints that barely move
/// these limbs are omitted, such as those that twist a limb about its axis.
[[nodiscard]] std::vector<JointOffset> find_joint_offsets(const RobotClip& clip,
                                                          const LimitSet& limits,
                                                          const std::vector<LimbDirections>& limbs);

/// Penalty for each offset, rad, as used by measure_joint_offsets.
[[nodiscard]] std::vector<double> weigh_offsets(const std::vector<JointOffset>& offsets,
                                                const std::vector<std::pair<int, int>>& pairs);

/// Measures the largest penalty. If the corresponding joint of the other arm has an offset as well,
/// the penalty is the difference of both amounts, but at least half of the larger one, because a
/// broad body offsets both arms equally.
/// @param limbs  without legs, which must reach the floor with other lengths than the human's.
/// @param hands  axes of hands, for joints that limbs do not determine.
void measure_joint_offsets(const ReportBuilder& draft, const LimitSet& limits,
                           const std::vector<LimbDirections>& limbs,
                           const std::vector<LimbDirections>& hands);

}  // namespace retarget
