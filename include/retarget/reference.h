#pragma once

#include <cstddef>
#include <cstdint>
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
  /// Planted heels and toes per frame of the clip; empty: unknown.
  std::optional<FootContacts> planted;
  /// The scene around the robot, in the frames of the clip; null: only the floor.
  const SceneClip* scene = nullptr;
  /// A reference that needs more memory is an error.
  std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
};

/// A joint that was moved between frames, or that remains beyond a limit.
struct ReferenceLimit {
  enum class Kind : unsigned char { kPosition, kSpeed, kTorque };
  Kind kind = Kind::kPosition;
  std::string joint;
  double time = 0.0;   ///< Of the largest value, seconds.
  double value = 0.0;  ///< Largest value: rad, rad/s or N m (m, m/s or N for slides).
  double limit = 0.0;  ///< The exceeded limit.
};
struct ReferenceCorrection {
  std::string joint;
  double time = 0.0;     ///< Approximate time of the largest change, seconds.
  double largest = 0.0;  ///< Bound for the change of the joint's position, rad or m.
};

/// The motion of a robot for a controller (docs/references.md): positions, velocities and
/// accelerations that are exactly consistent, with forces and torques. SI units; world frame with z
/// up. Arrays are row-major with one row per sample; n output joints, p contact points.
struct MotionReference {
  std::string robot;
  FrameRate rate;
  std::size_t samples = 0;
  std::vector<std::string> joint_names;  ///< n, in the order of the robot's output columns.

  std::vector<double> time;  ///< Seconds.
  std::vector<double> qpos;  ///< 7 + n: root x y z, root quaternion w x y z, joints.
  /// 6 + n: linear velocity of the root in the world, angular velocity in the root's own axes,
  /// joint velocities, as MuJoCo's qvel.
  std::vector<double> qvel;
  std::vector<double> qacc;  ///< 6 + n: time derivatives of qvel.

  /// False for a robot without masses: all members below are then empty.
  bool has_dynamics = false;
  double mass = 0.0;           ///< kg.
  std::vector<double> torque;  ///< n: joint torques under the contact forces, N m (N for slides).
  /// 6: the force (world) and torque (about the root's origin, in its axes) that contacts cannot
  /// supply, so a floating base lacks them. For a fixed base, the load on its stand.
  std::vector<double> residual;
  std::vector<double> com, com_velocity, com_acceleration;  ///< 3 each: centre of mass.
  std::vector<double> angular_momentum;  ///< 3: about the centre of mass, world, kg m^2/s.
  /// Points that touch something in at least one sample: `link/0`, `link/1`, ...
  std::vector<std::string> contact_names, contact_links;
  std::vector<std::uint8_t> contacts;    ///< p: 1 if a point may carry a force.
  std::vector<double> contact_position;  ///< p x 3: world, of every point at every sample.
  std::vector<double> contact_force;     ///< p x 3: world, on the robot; 0 without contact.

  std::optional<FootContacts> planted;  ///< One row per sample; empty: unknown.

  /// n each: joint ranges, speed limits and torque limits; infinity if there is none.
  std::vector<double> lower, upper, speed_limits, torque_limits;
  std::vector<ReferenceCorrection> corrections;  ///< Joints moved to keep limits between frames.
  /// Values that remain beyond limits, one entry per joint and kind. Positions and speeds are
  /// bounded by exact extremes of the spline, torques by the samples.
  std::vector<ReferenceLimit> beyond;
};

/// Samples the C2 spline through a motion with its exact derivatives, and finds the forces at its
/// contacts and the torques of its joints. Samples are at 0, 1/rate, ... up to the last frame.
///
/// Joint positions and speeds keep their limits between frames as well: where the spline leaves
/// them, its coefficients move as little as necessary (UniformSpline::keep_inside). A frame that is
/// itself beyond a limit stays there and is reported.
///
/// Contacts and forces are those of `evaluate --dynamics` (docs/dynamics.md): points near the floor
/// or a body of the scene that are slow, and non-negative least squares within friction pyramids.
///
/// Errors (kUsage): a rate outside its range. Errors (kInput): a motion without frames; more memory
/// than allowed. Errors of make_distance_field.
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
