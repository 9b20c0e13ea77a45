#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "fit/fit_model.h"
#include "live/floor_finder.h"
#include "retarget/options.h"
#include "retarget/pose.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// Keeps feet that stand where they came to stand, and soles on the floor, as far as that can be told
/// from what was seen so far: small shifts of targets before they are solved, of the root afterwards.
class FootHolder {
 public:
  FootHolder(const FitModel& model, const FitOptions& options, double frame_time, std::size_t feet);

  /// Draws the targets of feet in contact to their places.
  /// @param floor  height of the floor, metres above the source's origin.
  void hold(std::span<const LiveFoot> feet, double floor, const Eigen::Vector3d& path,
            std::span<Pose> world_from_target);
  /// Brings soles that stand to the floor, and nothing below it; sees where they slide.
  /// @param qpos  its root is raised or lowered.
  void stand(std::span<const LiveFoot> feet, std::span<double> qpos);
  void restart();

  [[nodiscard]] bool in_contact(std::size_t foot) const { return held_[foot].on; }

 private:
  struct HeldFoot {
    bool on = false;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // of the target
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    std::optional<Eigen::Vector2d> stood;            // where the robot's sole came to stand
    Eigen::Vector2d back = Eigen::Vector2d::Zero();  // what brings it back there
  };
  void bring_back(const LiveFoot& foot, HeldFoot& held) const;

  const FitModel& model_;
  const FitOptions& options_;
  double size_;                     // of the robot: lengths of contacts
  double ease_, release_, settle_;  // shares that go on to the next frame
  std::vector<HeldFoot> held_;
  TreeState pose_;
  double raise_ = 0.0;  // metres
};

}  // namespace retarget
