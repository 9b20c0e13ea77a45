#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "fit/fit_model.h"
#include "retarget/human.h"
#include "retarget/options.h"
#include "retarget/pose.h"

namespace retarget {

/// One of the robot's feet and the human's that it goes after, frame by frame.
class LiveFoot {
 public:
  /// @param task  of the robot's foot.
  LiveFoot(const FitModel& model, const FitTask& task, double frame_time);

  /// Takes the next frame.
  void add(const HumanPose& world_from_bone, std::span<const Pose> world_from_target,
           const Eigen::Vector3d& path);
  /// What comes next says nothing of what came before.
  void restart() { count_ = 0; }

  [[nodiscard]] int target() const { return target_; }
  /// Index of the robot's foot.
  [[nodiscard]] int foot() const { return foot_; }
  /// Where its target has the sole, metres above the source's origin.
  [[nodiscard]] double sole_height() const { return sole_height_; }
  /// Of the human's heel or toe, whichever is faster, m/s.
  [[nodiscard]] double speed() const { return speed_; }
  /// Height of the unit vector that points up from toes that stand.
  [[nodiscard]] double up() const { return up_; }

 private:
  struct Ends {
    Eigen::Vector3d ankle = Eigen::Vector3d::Zero(), toe = Eigen::Vector3d::Zero();
  };
  Bone ankle_, toe_;
  int target_, foot_;
  double body_height_;
  double frame_time_;
  std::array<Ends, 8> latest_{};  // by frame, modulo their number
  std::size_t apart_;             // frames that a speed is taken over
  std::size_t count_ = 0;
  double sole_height_ = 0.0, speed_ = 0.0, up_ = 1.0;
};

/// The feet of a robot that go after something.
[[nodiscard]] std::vector<LiveFoot> live_feet(const FitModel& model, double frame_time);

/// Where the source's floor is, by what its feet have stood on so far: they tell anew all the time, so
/// that neither a wrong start nor a sensor that drifts lets the robot float.
class FloorFinder {
 public:
  FloorFinder(const FitOptions& options, double frame_time);

  /// Takes the next frame of the feet.
  /// @return height of the floor by now, metres above the source's origin.
  double add(std::span<const LiveFoot> feet);
  void restart();

 private:
  [[nodiscard]] double estimate();

  double max_speed_;
  double step_;  // metres that the floor moves in a frame
  std::array<double, 512> heights_{}, scratch_{};
  std::size_t count_ = 0;
  int wait_ = 0;
  bool begun_ = false;
  double floor_ = 0.0, goal_ = 0.0;
};

}  // namespace retarget
