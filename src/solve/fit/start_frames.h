#pragma once

#include <Eigen/Core>
#include <span>

#include "retarget/kinematic_tree.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"

namespace retarget {

/// Height of the robot's lowest point (soles and shapes), metres; 0 if no point is below the floor.
[[nodiscard]] double lowest_below_floor(const FitModel& model, const TreeState& pose);

/// Receives the frames of the first stage in order and makes the start configurations of the fit.
/// Raises the root until no point is below the floor and, in a scene, no part that carries the
/// robot is below its surface. At the last frame of a contact, sets the contact's anchor to the mean
/// position over its frames.
class StartFrames {
 public:
  /// @param path  offset added to the root's position, by frame, metres.
  /// @param lift  whether to raise the root if a point is below the floor.
  StartFrames(const FitModel& model, std::span<const Eigen::Vector3d> path, bool lift,
              FitClip& clip);

  /// Writes the start configuration of a frame and adds the frame to the anchors of its contacts.
  /// @param qpos  the frame's solution of the first stage.
  void take(int frame, std::span<const double> qpos);

 private:
  [[nodiscard]] double lowest_below_ground(int frame) const;
  void add_to_anchors(int frame);

  const FitModel& model_;
  std::span<const Eigen::Vector3d> path_;
  bool lift_;
  FitClip& clip_;
  TreeState pose_;
};

}  // namespace retarget
