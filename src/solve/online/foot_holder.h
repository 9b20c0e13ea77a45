#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "solve/fit/fit_model.h"
#include "solve/online/floor_finder.h"

namespace retarget {

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
