#pragma once

#include <optional>
#include <string>
#include <vector>

#include "retarget/base/result.h"
#include "retarget/io/motion_format.h"
#include "retarget/robot/robot_clip.h"

namespace retarget {

/// Which joints and bodies the arrays of a tracking file have, and in which order.
///
/// Bodies are the root and those that an output joint moves; what is fixed to a body, or held by
/// the robot's variant, counts as a part of it (so does Isaac Lab's importer, and mjlab's models
/// have no such bodies). kNpzMjlab: MuJoCo's order, depth first. kNpzBeyondMimic: Isaac Lab's,
/// breadth first: by depth in the tree of those bodies, among equals in MuJoCo's order.
struct TrackingLayout {
  std::vector<int> joints;  ///< Indices into Robot::joints().
  std::vector<int> bodies;  ///< Indices into Robot::bodies().
};

/// @param format  kNpzMjlab or kNpzBeyondMimic
[[nodiscard]] TrackingLayout tracking_layout(const Robot& robot, MotionFormat format);

/// Whose velocity `body_lin_vel_w` is.
enum class BodyPoint : unsigned char {
  kLink,  ///< The link's origin, as mjlab has it.
  kMass,  ///< The centre of mass of the link and what is fixed to it, as Isaac Lab has it.
};

struct TrackingOptions {
  FrameRate rate{50, 1};
  std::optional<BodyPoint> velocity_of;  ///< Nothing: as the format's trainer has it.
};

/// The arrays that motion trackers train from, row by row; world frame, Z up, SI, wxyz.
struct TrackingMotion {
  MotionFormat format = MotionFormat::kNpzMjlab;
  FrameRate rate;
  std::size_t frames = 0;
  std::vector<std::string> joint_names, body_names;
  std::vector<double> joint_pos, joint_vel;        ///< frames x joints
  std::vector<double> body_pos, body_quat;         ///< frames x bodies x 3, x 4
  std::vector<double> body_lin_vel, body_ang_vel;  ///< frames x bodies x 3
};

/// What BeyondMimic's and mjlab's csv_to_npz make by replaying a CSV in a simulator, computed by
/// kinematics alone.
///
/// Samples are at 0, 1/rate, ... strictly before the last frame; between frames positions and
/// joints are linear, rotations slerp. Velocities are central differences of the samples, one-sided
/// at the ends for positions and joints; the root's angular velocity is log(q[i+1] q[i-1]^-1) /
/// (2 dt) in the world, its first and last value repeated. The bodies' velocities follow from those
/// of root and joints.
///
/// Errors (kInput): fewer than three samples, for which no angular velocity can be told.
[[nodiscard]] Result<TrackingMotion> make_tracking_motion(const RobotClip& clip,
                                                          MotionFormat format,
                                                          const TrackingOptions& options = {});

/// As an NPZ file: `fps` (1,) int64, `joint_pos`, `joint_vel`, `body_pos_w`, `body_quat_w`,
/// `body_lin_vel_w`, `body_ang_vel_w` float32; beside them, which trainers pass over, `flavour`
/// and the names of joints and bodies. Errors (kRun): 4 GiB or more; a rate that is not whole.
[[nodiscard]] Result<std::string> format_tracking_npz(const TrackingMotion& motion);

}  // namespace retarget
