#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/clip.h"
#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"
#include "retarget/scene.h"

namespace RETARGET_API retarget {

/// Range of ReferenceOptions::rate, samples per second.
inline constexpr double kMinReferenceRate = 10.0, kMaxReferenceRate = 1000.0;

/// Options of make_reference.
struct ReferenceOptions {
  FrameRate rate{200, 1};  ///< Samples per second.
  LimitSet limits;         ///< Joint ranges, rad or m; empty vectors: the robot's default set.
  /// Contacts of heels and toes per frame of the clip; empty: unknown.
  std::optional<FootContacts> planted;
  /// The scene around the robot, one pose per frame of the clip; null: only the floor.
  const SceneClip* scene = nullptr;
  /// Largest memory of a reference, bytes. A larger reference is an error.
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
  /// Called between samples; returning false stops the work (kInterrupted).
  std::function<bool()> keep_going = {};
};

/// A joint whose position, speed or torque is beyond a limit.
struct ReferenceLimit {
  enum class Kind : unsigned char { kPosition, kSpeed, kTorque };
  Kind kind = Kind::kPosition;
  std::string joint;
  double time = 0.0;   ///< Time of the worst value, seconds.
  double value = 0.0;  ///< Worst value: rad, rad/s or N m (m, m/s or N for slides).
  double limit = 0.0;  ///< The exceeded limit, in the same unit.
};

/// A joint whose spline was changed between frames to keep its limits.
struct ReferenceCorrection {
  std::string joint;
  double time = 0.0;     ///< Approximate time of the largest change, seconds.
  double largest = 0.0;  ///< Upper bound of the change of the joint's position, rad or m.
};

/// A motion of a robot for a controller (docs/references.md): positions with their exact velocities
/// and accelerations, contact forces and joint torques. SI units; world frame with z up. Arrays are
/// row-major with one row per sample. A row has the stated number of values, with n output joints
/// and p contact points.
struct MotionReference {
  std::string robot;  ///< Name of the robot.
  FrameRate rate;
  std::size_t samples = 0;
  std::vector<std::string> joint_names;  ///< n, in the order of the robot's output columns.

  std::vector<double> time;  ///< Seconds.
  std::vector<double> qpos;  ///< 7 + n: root x y z, root quaternion w x y z, joints.
  /// 6 + n: linear velocity of the root in the world, angular velocity in the root's own axes,
  /// joint velocities; the same as MuJoCo's qvel.
  std::vector<double> qvel;
  std::vector<double> qacc;  ///< 6 + n: time derivatives of qvel.

  /// False for a robot without masses: all members below are then empty.
  bool has_dynamics = false;
  double mass = 0.0;           ///< kg.
  std::vector<double> torque;  ///< n: joint torques under the contact forces, N m (N for slides).
  /// 6: the force (world) and torque (about the root's origin, in its axes) that the motion
  /// requires and the contacts cannot supply. For a fixed base, the load on its stand.
  std::vector<double> residual;
  std::vector<double> com, com_velocity, com_acceleration;  ///< 3 each: centre of mass.
  std::vector<double> angular_momentum;  ///< 3: about the centre of mass, world, kg m^2/s.
  /// The p points that are in contact in at least one sample, `link/0`, `link/1`, ..., and their
  /// links.
  std::vector<std::string> contact_names, contact_links;
  std::vector<std::uint8_t> contacts;    ///< p: 1 if the point is in contact.
  std::vector<double> contact_position;  ///< p x 3: position, world, also without contact.
  std::vector<double> contact_force;     ///< p x 3: world, on the robot; 0 without contact.

  std::optional<FootContacts> planted;  ///< One row per sample; empty: unknown.

  /// n each: joint ranges, speed limits and torque limits; infinity if there is none.
  std::vector<double> lower, upper, speed_limits, torque_limits;
  std::vector<ReferenceCorrection> corrections;  ///< Joints changed to keep limits between frames.
  /// Values that remain beyond limits, one entry per joint and kind. Positions and speeds are
  /// bounded by exact extremes of the spline, torques by the samples.
  std::vector<ReferenceLimit> beyond;
};

/// Samples a C2 spline through a motion with its exact derivatives, and computes contact forces and
/// joint torques. Samples are at 0, 1/rate, ... up to the last frame.
///
/// Joint positions and speeds also keep their limits between frames: where the spline exceeds them,
/// its coefficients change as little as necessary (UniformSpline::keep_inside). A frame that itself
/// exceeds a limit stays unchanged and is reported.
///
/// Contacts and forces are those of `evaluate --dynamics` (docs/dynamics.md): contacts are slow
/// points near the floor or a body of the scene, and forces solve a non-negative least-squares
/// problem within friction pyramids.
///
/// Errors (kUsage): a rate outside its range. Errors (kInput): a motion without frames; more memory
/// than allowed. Errors of make_distance_field. kInterrupted.
[[nodiscard]] Result<MotionReference> make_reference(const RobotClip& clip,
                                                     const ReferenceOptions& options = {});

/// Formats a reference as NPZ: float64 arrays with the names of docs/references.md.
/// Errors (kRun): 4 GiB or more.
[[nodiscard]] Result<std::string> format_reference_npz(const MotionReference& reference);

/// Formats a reference as CSV: a header line, then one row per sample with ten significant
/// digits. The same values as the NPZ, in the same order.
[[nodiscard]] std::string format_reference_csv(const MotionReference& reference);

/// Column names of the CSV, in order.
[[nodiscard]] std::vector<std::string> reference_columns(const MotionReference& reference);

/// Corrections, and values that remain beyond limits, as texts of a summary.
[[nodiscard]] std::vector<std::string> reference_notes(const MotionReference& reference);

}  // namespace retarget
