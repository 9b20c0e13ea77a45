#pragma once

#include <string>

#include "retarget/base/result.h"
#include "retarget/io/motion_format.h"
#include "retarget/io/robot_csv.h"
#include "retarget/io/tracking_motion.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

struct WriteMotionOptions {
  RobotCsvOptions csv;       ///< Of kCsv; kCsvSoma takes its precision alone.
  TrackingOptions tracking;  ///< Of the NPZ formats.
  std::string name;          ///< Of the motion: the key in a kPklPbhc file; empty: `motion`.
};

/// The bytes of a file that holds the motion.
///
/// kPklGmr: a dictionary of `fps`, `root_pos` (F, 3), `root_rot` (F, 4) xyzw and `dof_pos` (F, n),
/// float64, and, as robot frames of bodies, `local_body_pos` (F, B, 3) float32: all bodies below
/// the world with the root at the origin, unturned, named by `link_body_list`.
///
/// kPklPbhc: {name: {`root_trans_offset` (F, 3), `pose_aa` (F, 1 + n + 3, 3): rotation vectors of
/// the root and, about their axes, of the joints, then three rows of zeros, `dof` (F, n),
/// `root_rot` (F, 4) xyzw, `fps`}}, float32. Where the profile has a variant made for PBHC (its
/// name ends in `pbhc`) and the robot is whole, its joints are taken.
///
/// Errors: make_tracking_motion's and format_tracking_npz's.
[[nodiscard]] Result<std::string> format_robot_motion(const RobotClip& clip, MotionFormat format,
                                                      const WriteMotionOptions& options = {});

/// The clip for another variant of its robot: joints that this one holds are where it holds them.
[[nodiscard]] RobotClip with_robot(const RobotClip& clip, std::shared_ptr<const Robot> robot);

/// The robot that PBHC's files are of: see kPklPbhc.
[[nodiscard]] Result<std::shared_ptr<const Robot>> pbhc_robot(
    const std::shared_ptr<const Robot>& robot);

}  // namespace retarget
