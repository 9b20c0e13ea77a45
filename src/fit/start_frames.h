#pragma once

#include <Eigen/Core>
#include <span>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// Height of the robot's lowest point, soles and shapes, where it is below the floor: negative, or 0.
[[nodiscard]] double lowest_below_floor(const FitModel& model, const TreeState& pose);

/// Takes the start of a clip's frames, one after the other, as the first stage solves them: raises
/// the root until nothing is below the floor, and finds the place of each contact, the mean of the
/// heel or toe over its phase, with the phase's last frame.
class StartFrames {
 public:
  /// @param path  by frame: what is added to the root's position.
  StartFrames(const FitModel& model, std::span<const Eigen::Vector3d> path, bool lift,
              FitClip& clip);

  /// Writes the frame's configuration, and the places of contacts that end with it.
  void take(int frame, std::span<const double> qpos);

 private:
  void add_to_anchors(int frame);

  const FitModel& model_;
  std::span<const Eigen::Vector3d> path_;
  bool lift_;
  FitClip& clip_;
  TreeState pose_;
};

}  // namespace retarget
