#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "retarget/human.h"
#include "retarget/kinematic_tree.h"
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

/// Holds stance feet in place and soles on the floor, using past frames only. Applies small shifts
/// to the targets before the solve and to the root afterwards.
class FootHolder {
 public:
  FootHolder(const FitModel& model, const FitOptions& options, double frame_time, std::size_t feet);

  /// Moves the targets of feet in contact towards their anchors.
  /// @param floor  height of the floor, metres above the source's origin.
  void hold(std::span<const TrackedFoot> feet, double floor, const Eigen::Vector3d& path,
            std::span<Pose> world_from_target);
  /// Moves stance soles to the floor and raises the robot so that nothing is below it; measures how
  /// far stance soles slide.
  /// @param qpos  its root is raised or lowered.
  void stand(std::span<const TrackedFoot> feet, std::span<double> qpos);
  void restart();

  [[nodiscard]] bool in_contact(std::size_t foot) const { return held_[foot].on; }

 private:
  struct HeldFoot {
    bool on = false;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // Anchor of the target.
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    std::optional<Eigen::Vector2d> stood;            // Sole position at touchdown.
    Eigen::Vector2d back = Eigen::Vector2d::Zero();  // Target shift that counters sliding.
  };
  void bring_back(const TrackedFoot& foot, HeldFoot& held) const;

  const FitModel& model_;
  const FitOptions& options_;
  double size_;                     // Robot size relative to the source; scales contact heights.
  double ease_, release_, settle_;  // Fractions kept per frame.
  std::vector<HeldFoot> held_;
  TreeState pose_;
  double raise_ = 0.0;  // metres
};

}  // namespace retarget
