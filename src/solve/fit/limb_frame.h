#pragma once

#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/limb_solver.h"

namespace retarget {

/// A copy of one frame of a clip, in which a limb can be moved and solved.
///
/// Keeps references to its arguments.
class LimbFrame {
 public:
  LimbFrame(const FitModel& model, const FitClip& clip, const FitLimb& limb);

  /// Copies the current configuration of a frame of the clip.
  void set(int frame);
  /// Sets the joint positions of the limb.
  void place(const LimbJoints& joints);
  /// Solves the limb inside `range`. @return the remaining tracking cost.
  double solve(const LimbRange& range);

  /// Joint positions of the limb.
  [[nodiscard]] LimbJoints joints() const;
  /// Tracking cost of the limb.
  [[nodiscard]] double cost() const { return solver_.cost(pose_, goals()); }
  [[nodiscard]] FrameGoals goals() const { return clip_.goals(frame_, model_.tasks.size()); }
  [[nodiscard]] const TreeState& pose() const { return pose_; }

  [[nodiscard]] const LimbRange& limits() const { return solver_.limits(); }
  /// The part of the joint limits at a distance of at most `step` from `joints`; rad or m.
  [[nodiscard]] LimbRange within_reach(const LimbJoints& joints, double step) const;

 private:
  const FitModel& model_;
  const FitClip& clip_;
  const FitLimb& limb_;
  LimbSolver solver_;
  TreeState pose_;            // Forward kinematics of qpos_.
  std::vector<double> qpos_;  // The frame's configuration with the limb's current positions.
  int frame_ = 0;
};

}  // namespace retarget
