#pragma once

#include <memory>
#include <optional>
#include <span>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/human.h"
#include "retarget/plan.h"
#include "retarget/robot.h"

namespace RETARGET_API retarget {

/// Options of OnlineSolver.
struct OnlineOptions {
  double frame_time = 0.02;  ///< Seconds from one pose to the next, above 0.
  /// Fits a moving window of the latest poses: smoother, but a configuration is output at this age,
  /// seconds. Empty: every pose is solved on arrival. Requires the method `fit`.
  std::optional<double> lag_s;
  bool floor = true;      ///< Without a window: keep the lowest point of the robot on the floor.
  bool hold_feet = true;  ///< Without a window: pull feet in contact to their contact positions.
};

/// Solves human poses at a constant rate for configurations of a robot, from past poses only. It
/// makes the targets, runs the two-pass inverse kinematics, estimates the floor and keeps feet in
/// contact on it. It neither uses a clock nor limits speeds; LiveSession (live.h) does both. Use an
/// object from one thread at a time. Nothing is allocated per pose, except after restart.
class OnlineSolver {
 public:
  /// @param plan  from make_plan, with its clip: a few frames of the performer, which determine the
  ///     limb lengths. The plan's method selects the targets.
  /// Errors: those of make_targets.
  [[nodiscard]] static Result<OnlineSolver> make(const Plan& plan, const OnlineOptions& options);
  ~OnlineSolver();
  OnlineSolver(OnlineSolver&&) noexcept;
  OnlineSolver& operator=(OnlineSolver&&) noexcept;

  enum class Outcome : unsigned char {
    kSolved,   ///< There is a new configuration, qpos().
    kFilling,  ///< The window is not full yet.
    kFailed,   ///< The pose cannot be solved and was skipped.
  };
  /// Solves the next pose.
  /// @param world_from_bone  metres, Z up; all values finite.
  Outcome push(const HumanPose& world_from_bone);
  /// Ends the stream and takes the next remaining configuration of the window.
  /// @return false if there is none.
  [[nodiscard]] bool take_rest();
  /// The latest configuration, layout of RobotClip; valid until the next call.
  [[nodiscard]] std::span<const double> qpos() const;

  /// Declares a discontinuity: the next pose is unrelated to earlier ones.
  /// @param from_several_starts  the next pose is solved from several starts, which takes
  ///     milliseconds and allocates. Method `fit` only.
  void restart(bool from_several_starts);
  /// Restores the initial state, for another stream of the same body.
  void reset();

  /// Number of poses in the window; 0 without one.
  [[nodiscard]] int window_frames() const;
  /// Number of the window's solver steps since the last call that gave non-finite values and were
  /// discarded.
  [[nodiscard]] int take_failed_steps();
  [[nodiscard]] const Robot& robot() const;

 private:
  class Impl;
  explicit OnlineSolver(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
