#pragma once

#include <span>
#include <string>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/motion/frame_rate.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

/// Order of the four quaternion columns.
enum class QuaternionOrder { kXyzw, kWxyz };

/// The dialect of a robot CSV. The defaults are the bytes of Unitree's published G1 data, which
/// BeyondMimic, mjlab, unitree_rl_lab and PBHC read.
struct RobotCsvOptions {
  int precision = 6;     ///< Digits after the decimal point, 0 to 17; others as the nearer of them.
  char delimiter = ',';  ///< `,`, blank or tab.
  bool header = false;   ///< A first line that names the columns.
  QuaternionOrder quaternion_order = QuaternionOrder::kXyzw;
  bool frame_column = false;  ///< A first column that counts frames from 0,
  int frame_step = 1;         ///< by so many.
  bool degrees = false;       ///< Hinges in degrees.
  bool centimetres = false;   ///< Root position and slides in centimetres.
  /// The root's rotation as three angles about the fixed axes x, y, z, in that order (R = Rz Ry
  /// Rx), degrees or radians as the joints, in place of a quaternion.
  bool euler = false;
};

/// The dialect of SOMA and BONES-SEED: comma, header, frame column, centimetres, degrees, Euler.
/// Its readers take 120 frames a second, and so its frame numbers count: where 120 is a multiple of
/// the rate they go up by as many (at 30 fps 0, 4, 8, ...), else by one.
[[nodiscard]] RobotCsvOptions soma_csv_options(const FrameRate& rate, int precision = 6);

/// Whether the frame numbers of soma_csv_options tell this rate.
[[nodiscard]] bool soma_csv_tells(const FrameRate& rate);

/// Writes configurations as lines: root position x y z (metres), root quaternion, then the joints
/// (radians, metres for slides) in the robot's output order; other units and columns as the
/// options say. Fixed notation, LF, no negative zeros, the same bytes in every locale.
///
/// A header names columns `root_x`, `root_qx`, the joint's name; with Euler angles as SOMA does:
/// `Frame`, `root_translateX`, `root_rotateX`, the joint's name and `_dof`.
class RobotCsvFormatter {
 public:
  explicit RobotCsvFormatter(const Robot& robot, const RobotCsvOptions& options = {});

  /// What stands before the first line: the header, or nothing.
  [[nodiscard]] const std::string& header() const { return header_; }

  /// @param qpos   configuration in the layout of RobotClip.
  /// @param frame  its number, for the frame column.
  void append_line(std::span<const double> qpos, std::string& text, int frame = 0) const;

 private:
  struct Column {
    int address;  // into a configuration
    double factor;
  };
  void append_value(double value, std::string& text) const;

  RobotCsvOptions options_;
  std::vector<Column> position_, rotation_, joints_;  // in the order in which they are written
  std::string header_;
};

/// The whole file for a clip.
[[nodiscard]] std::string format_robot_csv(const RobotClip& clip,
                                           const RobotCsvOptions& options = {});

/// The clip as a reader of its CSV has it: every number as it is printed, joints that are no columns
/// as in the zero configuration, quaternions of unit length and sign-continuous.
/// Errors (kRun): a quaternion of which so few digits leave nothing.
[[nodiscard]] Result<RobotClip> printed_clip(const RobotClip& clip, int precision = 6);

}  // namespace retarget
