#pragma once

#include <functional>
#include <string>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"

namespace RETARGET_API retarget {

/// Deviation from the reference at which a simulated robot has fallen or is lost, for a robot as
/// large as a G1; lengths scale with the legs (docs/simulation.md).
inline constexpr double kFallHeight = 0.25;  ///< Root below the reference, metres.
inline constexpr double kFallTilt = 45.0;    ///< Between the root's vertical axes, degrees.
/// Horizontal distance of the root from the reference, metres.
inline constexpr double kLostDistance = 0.5;

/// A mean and a 95th percentile.
struct MeanAndP95 {
  double mean = 0.0, p95 = 0.0;
};

/// Result of a physics simulation in which a robot tracks a motion. Metrics other than the fall
/// cover the time before the fall.
struct SimulationReport {
  std::string robot;
  int frames = 0;          ///< Of the reference.
  double fps = 0.0;        ///< Of the reference.
  double time_step = 0.0;  ///< Of the simulation, seconds.
  bool fell = false;
  int fall_frame = -1;           ///< Frame at whose time or before which it fell; -1: it did not.
  double fall_time_s = 0.0;      ///< Time of the fall; if there is none, the motion's length.
  std::string fall_reason;       ///< `height`, `tilt`, `distance`, `diverged`; empty: no fall.
  MeanAndP95 joint_deg;          ///< Error of hinges, degrees.
  MeanAndP95 root_cm, root_deg;  ///< Error of the root's position and rotation.
  MeanAndP95 body_cm;            ///< Error of body positions in the world, centimetres.
  bool knows_torque_limits = false;
  double torque_limit_pct = 0.0;  ///< Share of the time with a torque at its limit, %.
  double torque_p99_ratio = 0.0;  ///< 99th percentile of the largest torque relative to its limit.
  double slip_cm_s = 0.0;         ///< Mean horizontal speed of sole points on the floor, cm/s.
  int unsolved_steps = 0;  ///< Control steps whose QP was not solved; no torque acted in them.
};

/// A simulated motion, in the frames of its reference.
struct Simulation {
  RobotClip motion;
  SimulationReport report;
};

/// Options of simulate().
struct SimulateOptions {
  /// Asked once per frame; true stops the simulation (kInterrupted).
  std::function<bool()> is_stopped;
};

/// Replays a motion in MuJoCo: the robot's model on a plane, with torque limits, under a whole-body
/// controller that tracks the motion by a quadratic program over torques and contact forces
/// (docs/simulation.md). The robot starts in the motion's first frame with its velocity. After a
/// fall, the controller only damps the joints. The same input gives the same bytes on one machine.
///
/// Errors: a motion with fewer than three frames (kInput); a robot with a fixed base, without soles
/// or without masses (kConfig).
[[nodiscard]] Result<Simulation> simulate(const RobotClip& reference,
                                          const SimulateOptions& options = {});

/// The report as text, one metric per line.
[[nodiscard]] std::string simulation_text(const SimulationReport& report);
/// The report as JSON.
[[nodiscard]] std::string simulation_json(const SimulationReport& report);

}  // namespace retarget
