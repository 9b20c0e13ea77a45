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
  double frame_time = 0.02;  ///< Seconds between two poses, above 0.
  /// Delay of the output in seconds, for a fit over a moving window of the latest poses, which
  /// gives smoother motions. Empty: solves each pose immediately. Requires the method `fit`.
  std::optional<double> lag_s;
  bool floor = true;  ///< Without a window: whether to keep the robot's lowest point on the floor.
  bool hold_feet = true;  ///< Without a window: whether to hold feet in contact at their anchors.
};

/// Retargets a stream of human poses at a constant rate, from past poses only. It makes the
/// targets, runs the two-pass inverse kinematics, estimates the floor and holds feet in contact on
/// it. It neither uses a clock nor limits speeds; LiveSession (live.h) does both. Use an object
/// from one thread at a time. Does not allocate per pose, except after restart().
class OnlineSolver {
 public:
  /// Makes a solver.
  /// @param plan  plan of make_plan with its clip: a few frames of the performer, which determine
  ///     the limb lengths. The plan's method determines the targets.
  /// Errors: those of make_targets.
  [[nodiscard]] static Result<OnlineSolver> make(const Plan& plan, const OnlineOptions& options);
  ~OnlineSolver();
  OnlineSolver(OnlineSolver&&) noexcept;
  OnlineSolver& operator=(OnlineSolver&&) noexcept;

  /// Result of push().
  enum class Outcome : unsigned char {
    kSolved,   ///< There is a new configuration, qpos().
    kFilling,  ///< The window is not full yet.
    kFailed,   ///< The pose cannot be solved and was skipped.
  };
  /// Solves the next pose.
  /// @param world_from_bone  metres, Z up; all values finite.
  Outcome push(const HumanPose& world_from_bone);
  /// Ends the stream and sets qpos() to the next remaining configuration of the window.
  /// @return false if no configuration remains.
  [[nodiscard]] bool take_rest();
  /// The latest configuration, laid out as in RobotClip; valid until the next call.
  [[nodiscard]] std::span<const double> qpos() const;

  /// Prepares for a discontinuity: the next pose is unrelated to earlier ones.
  /// @param from_several_starts  whether to solve the next pose from several starts, which takes
  ///     milliseconds and allocates. Method `fit` only.
  void restart(bool from_several_starts);
  /// Restores the initial state, for another stream of the same body.
  void reset();

  /// Number of poses in the window; 0 without a window.
  [[nodiscard]] int window_frames() const;
  /// Number of the window's solver steps since the last call of this function that were discarded
  /// because of non-finite values.
  [[nodiscard]] int take_failed_steps();
  [[nodiscard]] const Robot& robot() const;

 private:
  class Impl;
  explicit OnlineSolver(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace retarget
