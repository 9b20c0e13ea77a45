#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Tracks one robot foot and the human foot that it follows, frame by frame.
class TrackedFoot {
 public:
  /// @param task  the task of the robot's foot.
  TrackedFoot(const FitModel& model, const FitTask& task, double frame_time);

  /// Adds the next frame.
  void add(const HumanPose& world_from_bone, std::span<const Pose> world_from_target,
           const Eigen::Vector3d& path);
  /// Declares a discontinuity: discards the earlier frames.
  void restart() { count_ = 0; }

  [[nodiscard]] int target() const { return target_; }
  /// Index of the robot's foot.
  [[nodiscard]] int foot() const { return foot_; }
  /// Height of the target's sole, metres above the source's origin.
  [[nodiscard]] double sole_height() const { return sole_height_; }
  /// Speed of the human's heel or toe, whichever is faster, m/s.
  [[nodiscard]] double speed() const { return speed_; }
  /// Vertical component of the toe's up vector; 1 for a foot flat on the ground.
  [[nodiscard]] double up() const { return up_; }

 private:
  struct Ends {
    Eigen::Vector3d ankle = Eigen::Vector3d::Zero(), toe = Eigen::Vector3d::Zero();
  };
  Bone ankle_, toe_;
  int target_, foot_;
  double body_height_;
  double frame_time_;
  std::array<Ends, 8> latest_{};  // Ring buffer.
  std::size_t apart_;             // Frames between the two positions of a speed.
  std::size_t count_ = 0;
  double sole_height_ = 0.0, speed_ = 0.0, up_ = 1.0;
};

/// The feet of the robot that have a task.
[[nodiscard]] std::vector<TrackedFoot> tracked_feet(const FitModel& model, double frame_time);

/// Estimates the height of the source's floor from the stances so far. The estimate is updated
/// continuously, so neither a wrong start nor sensor drift makes the robot float.
class FloorFinder {
 public:
  FloorFinder(const FitOptions& options, double frame_time);

  /// Adds the next frame of the feet.
  /// @return current estimate of the floor height, metres above the source's origin.
  double add(std::span<const TrackedFoot> feet);
  void restart();

 private:
  [[nodiscard]] double estimate();

  double max_speed_;
  double step_;  // Maximum change of the floor per frame, metres.
  std::array<double, 512> heights_{}, scratch_{};
  std::size_t count_ = 0;
  int wait_ = 0;
  bool begun_ = false;
  double floor_ = 0.0, goal_ = 0.0;
};

}  // namespace retarget
