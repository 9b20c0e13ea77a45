#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "solve/fit/block_chain.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/joint_speeds.h"
#include "solve/ik/active_set.h"

namespace retarget {

/// The active bounds of a window: variables that are held at a joint limit. A step does not move
/// them. After a step, a variable is released if the gradient at the solution of the step points
/// back into its range; the gradient before the step has no such meaning. ActiveSet uses the same
/// rule, but iterates until the set is stable. Here, a step is one such iteration, because each one
/// factorises the whole window and many bounds change.
class HeldLimits {
 public:
  /// @param frames  number of frames in the window.
  HeldLimits(const FitModel& model, std::size_t frames);

  /// The only state that outlives a step, by frame and degree of freedom.
  [[nodiscard]] const std::vector<BoundSide>& sides() const { return sides_; }
  void set_sides(std::vector<BoundSide> sides) { sides_ = std::move(sides); }
  [[nodiscard]] bool is_held(int frame, int dof) const {
    return sides_[index(frame, dof)] != BoundSide::kFree;
  }
  /// Clamps a joint to its range and holds it there if it left the range.
  void clamp(int frame, int dof, double& value);
  /// Drops the first frames of a moving window; new frames at its end are free.
  void move(std::size_t dropped, std::size_t frames);

  /// Call it before each step.
  void begin_step();
  /// Removes the held variables of a frame from its system, and keeps their rows for release().
  /// A row lacks the columns of variables with a lower index that are also held; their steps are 0.
  /// @param frame          relative to the window's first frame.
  /// @param hessian        rows of `stride` values; the lower triangle.
  /// @param coupling       diagonal of the block that couples the frame with the previous one.
  /// @param before, after terms of the steps to and from the frame; empty if the window has no such
  ///     step.
  void hold(int frame, double* hessian, double* gradient, int stride, double* coupling,
            std::span<const StepTerm> before, std::span<const StepTerm> after);
  /// Releases the variables that the solution pulls back into their ranges.
  void release(const BlockChain& chain);

 private:
  // A variable held at its limit. Its row of the frame's Hessian is in entries_.
  struct Row {
    int frame, dof;
    double gradient, before, after;
  };

  [[nodiscard]] std::size_t index(int frame, int dof) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(dofs_) +
           static_cast<std::size_t>(dof);
  }

  const FitModel& model_;
  int dofs_;
  std::vector<BoundSide> sides_;  // By frame and degree of freedom.
  std::vector<Row> rows_;
  std::vector<double> entries_;
};

}  // namespace retarget
