#pragma once

#include <span>
#include <vector>

#include "retarget/options.h"
#include "retarget/robot.h"

namespace retarget {

/// Follows configurations no faster than a robot may move. After an interruption it sets off slowly
/// and becomes faster, until it is where it is wanted.
class MotionLimiter {
 public:
  /// @param options  max_joint_speed and max_joint_step count.
  MotionLimiter(const Robot& robot, const LimitSet& limits, const FitOptions& options);

  /// The first configuration is taken as it is.
  /// @param wanted   in the layout of RobotClip; its root's quaternion of unit length.
  /// @param seconds  since the call before.
  /// @return whether a limit kept it back.
  bool follow(std::span<const double> wanted, double seconds);
  /// Takes a configuration whatever the limits; its quaternion gets the sign that goes on.
  void take(std::span<const double> wanted);

  /// What is wanted next may be anywhere.
  void set_off_slowly() { since_interruption_ = 0.0; }
  /// As made.
  void reset();

  [[nodiscard]] bool has_begun() const { return begun_; }
  [[nodiscard]] std::span<const double> qpos() const { return now_; }

 private:
  bool follow_root(std::span<const double> wanted, double seconds);

  struct JointRow {
    std::size_t address;
    double lower, upper, speed;  // rad, rad/s; metres
    bool slides;
  };
  std::vector<JointRow> joints_;
  double max_joint_step_;
  std::vector<double> now_;
  bool begun_ = false;
  double since_interruption_ = -1.0;  // seconds; negative: long ago
};

}  // namespace retarget
