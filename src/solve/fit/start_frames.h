#pragma once

#include <Eigen/Core>
#include <span>

#include "retarget/kinematic_tree.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Height of the robot's lowest point (soles and shapes), metres, if it is below the floor; else 0.
[[nodiscard]] double lowest_below_floor(const FitModel& model, const TreeState& pose);

/// Receives the start configurations of a clip's frames in order, as the first stage solves them.
/// Raises the root until nothing is below the floor. At the last frame of each contact, sets its
/// anchor to the mean position over its frames.
class StartFrames {
 public:
  /// @param path  by frame: offset added to the root's position, metres.
  /// @param lift  whether to raise the root.
  StartFrames(const FitModel& model, std::span<const Eigen::Vector3d> path, bool lift,
              FitClip& clip);

  /// Writes the configuration of a frame and adds it to the anchors of its contacts.
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
