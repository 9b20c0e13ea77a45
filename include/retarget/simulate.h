#pragma once

#include <functional>
#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"

namespace RETARGET_API retarget {

// Deviations from the reference beyond which a simulated robot has fallen, for a robot of a G1's
// size; lengths scale with the leg length (docs/simulation.md).
inline constexpr double kFallHeight = 0.25;   ///< Height of the root below the reference, metres.
inline constexpr double kFallTilt = 45.0;     ///< Angle between the roots' vertical axes, degrees.
inline constexpr double kLostDistance = 0.5;  ///< Horizontal distance of the roots, metres.

/// A mean and a 95th percentile.
struct MeanAndP95 {
  double mean = 0.0, p95 = 0.0;
};

/// Result of a physics simulation in which a robot tracks a motion. Metrics other than the fall
/// cover the time before the fall.
struct SimulationReport {
  std::string robot;
  int frames = 0;          ///< Number of frames of the reference.
  double fps = 0.0;        ///< Frames per second of the reference.
  double time_step = 0.0;  ///< Time step of the simulation, seconds.
  bool fell = false;
  int fall_frame = -1;           ///< First frame at or after the fall; -1: no fall.
  double fall_time_s = 0.0;      ///< Time of the fall; without a fall, the length of the motion.
  std::string fall_reason;       ///< `height`, `tilt`, `distance`, `diverged`; empty: no fall.
  MeanAndP95 joint_deg;          ///< Error of hinges, degrees.
  MeanAndP95 root_cm, root_deg;  ///< Error of the root's position (cm) and rotation (degrees).
  MeanAndP95 body_cm;            ///< Error of body positions in the world, centimetres.
  bool knows_torque_limits = false;  ///< Whether the limit of at least one joint is known.
  double torque_limit_pct = 0.0;     ///< Share of the time with a torque at its limit, %.
  /// 99th percentile of the largest ratio of a torque to its limit.
  double torque_p99_ratio = 0.0;
  double slip_cm_s = 0.0;  ///< Mean horizontal speed of sole points on the floor, cm/s.
  int unsolved_steps = 0;  ///< Number of control steps with an unsolved QP, which apply no torque.
};

/// A simulated motion, in the frames of its reference.
struct Simulation {
  RobotClip motion;
  SimulationReport report;
};

/// Options of simulate().
struct SimulateOptions {
  /// Called once per frame; returning true stops the simulation (kInterrupted).
  std::function<bool()> is_stopped;
};

/// Simulates a robot that tracks a motion, in MuJoCo: the robot's model on a plane, with torque
/// limits and a whole-body controller that solves a quadratic program in torques and contact forces
/// (docs/simulation.md). The robot starts with the pose and velocity of the motion's first frame.
/// After a fall, the controller only damps the joints. The result is reproducible on one machine.
///
/// Errors: a motion with fewer than three frames (kInput); a robot with a fixed base, without soles
/// or without masses (kConfig); `is_stopped` returned true (kInterrupted).
[[nodiscard]] Result<Simulation> simulate(const RobotClip& reference,
                                          const SimulateOptions& options = {});

/// The report as text, one metric per line.
[[nodiscard]] std::string simulation_text(const SimulationReport& report);
/// The report as JSON.
[[nodiscard]] std::string simulation_json(const SimulationReport& report);

}  // namespace retarget
