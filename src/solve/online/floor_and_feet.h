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

/// Tracks a robot's foot and the human foot that it follows, frame by frame.
class TrackedFoot {
 public:
  /// @param task  the task of the robot's foot.
  TrackedFoot(const FitModel& model, const FitTask& task, double frame_time);

  /// Adds the next frame.
  /// @param path  OnlineTargets::path() of the frame.
  void add(const HumanPose& world_from_bone, std::span<const Pose> world_from_target,
           const Eigen::Vector3d& path);
  /// Discards the earlier frames, for a discontinuity.
  void restart() { count_ = 0; }

  /// Index into the targets of a frame.
  [[nodiscard]] int target() const { return target_; }
  /// Index into FitModel::feet.
  [[nodiscard]] int foot() const { return foot_; }
  /// Height of the sole at its target, metres above the source's origin.
  [[nodiscard]] double sole_height() const { return sole_height_; }
  /// The larger of the speeds of the human's ankle and toe, m/s.
  [[nodiscard]] double speed() const { return speed_; }
  /// Vertical component of the toe's up vector; 1 for a level foot.
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
  std::size_t apart_;             // Number of frames over which a speed is measured.
  std::size_t count_ = 0;
  double sole_height_ = 0.0, speed_ = 0.0, up_ = 1.0;
};

/// The feet of the robot that have a task.
[[nodiscard]] std::vector<TrackedFoot> tracked_feet(const FitModel& model, double frame_time);

/// Estimates the height of the source's floor from past stances. It updates the estimate
/// continuously, so that the robot floats neither after a wrong start nor due to sensor drift. It
/// follows a vertical jump of the source's world: a step of the whole body between two frames.
class FloorFinder {
 public:
  FloorFinder(const FitOptions& options, double frame_time);

  /// Adds the current frame of the feet.
  /// @param lowest_part  height of the lowest target of other bodies, on the same scale. The first
  ///                     estimate is below it if the feet are clearly higher, as in a handstand.
  /// @param root         height of the target of the root, on the same scale.
  /// @return estimate of the floor height, metres above the source's origin.
  double add(std::span<const TrackedFoot> feet, double lowest_part, double root);
  /// Discards all stances.
  void restart();
  /// Discards the latest frames, for a discontinuity, after which the body may have another pose.
  void interrupt() { level_count_ = 0; }

 private:
  // Heights of the root and of the lower sole, metres.
  struct Level {
    double root = 0.0, sole = 0.0;
  };

  [[nodiscard]] double estimate();
  [[nodiscard]] const Level& level(std::size_t back) const {
    return levels_[(level_count_ - 1 - back) % levels_.size()];
  }
  [[nodiscard]] double jump() const;
  void follow_jump(const Level& now);

  double frame_time_;
  double max_speed_;
  double step_;  // Largest change of the estimate per frame, metres.
  std::array<double, 512> heights_{}, scratch_{};
  std::size_t count_ = 0;
  std::array<Level, 64> levels_{};  // Ring buffer of the latest frames.
  std::size_t level_count_ = 0;
  int wait_ = 0;
  bool begun_ = false;
  double floor_ = 0.0, goal_ = 0.0;
};

/// Holds feet in contact at their anchors and soles on the floor, from past frames only. Shifts the
/// targets before the solve and the root after it.
class FootHolder {
 public:
  FootHolder(const FitModel& model, const FitOptions& options, double frame_time, std::size_t feet);

  /// Moves the targets of feet in contact towards their anchors.
  /// @param floor  height of the floor, metres above the source's origin.
  void hold(std::span<const TrackedFoot> feet, double floor, const Eigen::Vector3d& path,
            std::span<Pose> world_from_target);
  /// Moves soles in contact to the floor, and raises the robot until no point is below the floor.
  /// Also measures the slide of these soles for the next hold().
  /// @param qpos  solution of the frame; the function changes the height of its root.
  void stand(std::span<const TrackedFoot> feet, std::span<double> qpos);
  /// Releases all feet, for a discontinuity.
  void restart();

  [[nodiscard]] bool in_contact(std::size_t foot) const { return held_[foot].on; }

 private:
  struct HeldFoot {
    bool on = false;                                  // Whether it is in contact.
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // Anchor of the target.
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // Shift of the target towards the anchor.
    std::optional<Eigen::Vector2d> stood;             // Position of the sole at touchdown.
    Eigen::Vector2d back = Eigen::Vector2d::Zero();   // Shift of the target against sliding.
  };
  void bring_back(const TrackedFoot& foot, HeldFoot& held) const;

  const FitModel& model_;
  const FitOptions& options_;
  double size_;  // Size of the robot relative to a human; scales contact heights.
  double ease_, release_, settle_;  // Share of a difference that remains after a frame.
  std::vector<HeldFoot> held_;
  TreeState pose_;
  double raise_ = 0.0;  // Current shift of the root's height, metres.
};

}  // namespace retarget
