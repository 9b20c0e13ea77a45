#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "retarget/base/result.h"
#include "retarget/io/robot_csv.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

struct ReadRobotCsvOptions {
  QuaternionOrder quaternion_order = QuaternionOrder::kXyzw;  ///< Where no header tells.
};

/// Reads a robot motion: a line per frame, root position x y z (metres), root quaternion, then the
/// joints (radians, metres for slides) in the robot's output order. Joints that are no columns
/// stand as in the zero configuration.
///
/// Columns are parted by commas, semicolons, tabs or blanks, found line by line. Empty lines and
/// lines that begin with # are passed over. A first line that does not begin with a number is a
/// header: where it names the robot's joints, columns are taken in its order, and where its fourth
/// column ends in `qw` or is `w`, quaternions are wxyz. One column too many is taken for a frame
/// number or a time before the others if it grows from line to line.
///
/// Quaternions are normalised and made sign-continuous.
///
/// @param rate  a CSV has none of its own.
/// @param file  for messages.
/// @return kInput errors with line and column: no lines, a wrong number of columns, what is no
///     number, numbers beyond 1e6, a quaternion without direction, unknown joints in a header that
///     names others.
[[nodiscard]] Result<RobotClip> parse_robot_csv(std::string_view text,
                                                const std::shared_ptr<const Robot>& robot,
                                                const FrameRate& rate, const std::string& file,
                                                const ReadRobotCsvOptions& options = {});

/// parse_robot_csv of a file; `-` reads standard input.
[[nodiscard]] Result<RobotClip> load_robot_csv(const std::string& path,
                                               const std::shared_ptr<const Robot>& robot,
                                               const FrameRate& rate,
                                               const ReadRobotCsvOptions& options = {});

}  // namespace retarget
