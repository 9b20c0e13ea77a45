#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "retarget/live.h"
#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// A robot standing upright: its zero configuration clamped to the limits, soles on the floor.
/// With a fixed base the root stays where it is.
class StandingPose {
 public:
  StandingPose(const Robot& robot, const LimitSet& limits);

  /// Moves the pose to the horizontal position and heading of a configuration.
  void place(std::span<const double> qpos);
  [[nodiscard]] std::span<const double> qpos() const { return qpos_; }

 private:
  std::vector<double> qpos_;
  bool stands_fast_ = false;
};

/// Follows configurations within limits on position, speed and acceleration, using elapsed time.
/// After an interruption the speed limits start at their resume values and ramp up to the full
/// ones.
///
/// A step never moves a joint or the root faster than allowed, nor changes a velocity by more than
/// the acceleration allows. The velocity of a step is its change over its duration, the time
/// between two velocities that between the middles of their steps. A joint near its position limit
/// is never faster than it can brake, whatever durations follow.
///
/// A receiver may also read the frames as evenly spaced. In uneven steps the same limits hold for a
/// frame's duration as well: that of speed unless the acceleration forbids it, that of acceleration
/// as far as the limits in real time allow.
///
/// Where no limit is active, the configuration is copied unchanged.
class MotionLimiter {
 public:
  /// Range of step durations, as fractions of a frame. A longer one is a pause of the process.
  static constexpr double kShortestStep = 0.4, kLongestStep = 1.6;

  /// @param fit  only max_joint_speed and max_joint_step are used.
  MotionLimiter(const Robot& robot, const LimitSet& limits, const FitOptions& fit,
                const LiveLimits& bounds, double frame_time);

  /// Takes one step towards a configuration. The first configuration is copied, clamped to the
  /// position limits.
  /// @param wanted   target in the layout of RobotClip; the root quaternion has unit length.
  /// @param seconds  time since the previous call, from kShortestStep to kLongestStep of a frame.
  /// @return whether a limit was active.
  bool follow(std::span<const double> wanted, double seconds);
  /// Takes a configuration regardless of the speed limits; flips the quaternion's sign if needed
  /// for continuity.
  void take(std::span<const double> wanted, double seconds);

  /// Takes one step without a target: brakes to a stop within the limits, then rests.
  /// @pre has_begun()
  /// @return whether it still moves.
  bool stop(double seconds);

  /// Declares an interruption: the next target may be anywhere, so speed limits ramp up again.
  void set_off_slowly();
  /// Whether the speed limits are still ramping up after set_off_slowly().
  [[nodiscard]] bool sets_off() const { return since_.has_value(); }
  /// Restores the state after construction.
  void reset();

  [[nodiscard]] bool has_begun() const { return begun_; }
  [[nodiscard]] std::span<const double> qpos() const { return now_; }

 private:
  struct JointRow {
    std::size_t address;
    double lower, upper;
    double speed, first_speed;  // rad/s or m/s
    double acceleration;        // rad/s^2 or m/s^2
    double velocity = 0.0;      // Of the previous step.
  };
  // A vector whose length is limited: the root's translation or rotation.
  struct RootPart {
    double speed, first_speed, acceleration;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // Of the previous step.
  };
  bool step_towards(std::span<const double> wanted, double seconds);
  bool follow_joint(JointRow& joint, double wanted, double seconds);
  bool follow_position(std::span<const double> wanted, double seconds);
  bool follow_rotation(std::span<const double> wanted, double seconds);
  std::optional<Eigen::Vector3d> limited_step(RootPart& part, const Eigen::Vector3d& way,
                                              const Eigen::Vector3d& aim, double seconds) const;
  [[nodiscard]] double between_middles(double seconds) const { return 0.5 * (before_ + seconds); }
  [[nodiscard]] bool is_uneven(double seconds) const;
  [[nodiscard]] double most_step(double speed, double seconds) const;
  [[nodiscard]] double ramped(double first, double full) const;
  [[nodiscard]] double ramped_acceleration(double full) const;

  LiveLimits bounds_;
  double frame_time_;
  double shortest_;  // Minimum step duration, seconds.
  double before_;    // Duration of the previous step, seconds.
  std::vector<JointRow> joints_;
  RootPart position_, rotation_;
  std::vector<double> now_, goal_;  // Current configuration and previous target.
  bool begun_ = false;
  bool has_goal_ = false;        // The previous target is valid, so the target's velocity is known.
  std::optional<double> since_;  // Seconds since an interruption.
};

}  // namespace retarget
