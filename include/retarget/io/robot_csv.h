#pragma once

#include <string>
#include <string_view>

#include "retarget/base/result.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

/// Order of the four quaternion columns.
enum class QuaternionOrder { kXyzw, kWxyz };

/// The dialect of a robot CSV. The defaults are the bytes of Unitree's published G1 data, which
/// BeyondMimic, mjlab, unitree_rl_lab and PBHC read.
struct RobotCsvOptions {
  int precision = 6;     ///< Digits after the decimal point, 0 to 17.
  char delimiter = ',';  ///< `,`, blank or tab.
  bool header = false;   ///< A first line that names the columns.
  QuaternionOrder quaternion_order = QuaternionOrder::kXyzw;
};

/// One line per frame: root position x y z (metres), root quaternion, then the joints (radians,
/// metres for slides) in the robot's output order. Fixed notation, LF, no negative zeros, the same
/// bytes in every locale.
[[nodiscard]] std::string format_robot_csv(const RobotClip& clip,
                                           const RobotCsvOptions& options = {});

}  // namespace retarget
