#pragma once

#include <string>
#include <vector>

#include "retarget/robot.h"
#include "robot/anatomy/limbs.h"

namespace retarget {

/// Faults of the soles in a profile, one sentence each.
struct SoleFaults {
  std::string missing;                 ///< Only one foot has a sole; empty: no fault.
  std::vector<std::string> misplaced;  ///< Soles that are not at the foot of their side.
};

/// Compares the soles of a robot's profile with its legs. A robot without soles has no faults.
/// @param anatomy  anatomy of this robot, with legs.
[[nodiscard]] SoleFaults check_soles(const Robot& robot, const RobotAnatomy& anatomy);

/// The remedy for SoleFaults::missing.
[[nodiscard]] std::string missing_sole_hint(const Robot& robot);

}  // namespace retarget
