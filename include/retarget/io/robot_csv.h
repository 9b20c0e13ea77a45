#pragma once

#include <span>
#include <string>
#include <vector>

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

/// Writes configurations as lines: root position x y z (metres), root quaternion, then the joints
/// (radians, metres for slides) in the robot's output order. Fixed notation, LF, no negative
/// zeros, the same bytes in every locale.
class RobotCsvFormatter {
 public:
  explicit RobotCsvFormatter(const Robot& robot, const RobotCsvOptions& options = {});

  /// What stands before the first line: the header, or nothing.
  [[nodiscard]] const std::string& header() const { return header_; }

  /// @param qpos  configuration in the layout of RobotClip.
  void append_line(std::span<const double> qpos, std::string& text) const;

 private:
  RobotCsvOptions options_;
  std::vector<int> columns_;  // of a configuration, in the order in which they are written
  std::string header_;
};

/// The whole file for a clip.
[[nodiscard]] std::string format_robot_csv(const RobotClip& clip,
                                           const RobotCsvOptions& options = {});

}  // namespace retarget
