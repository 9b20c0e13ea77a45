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

/// The variables of a window that are held at their limits. A step does not move them; one is
/// released if the solved step pulls it back inside, because the gradient before the step does not
/// decide. ActiveSet uses the same rule, but its loop would factorise the whole clip again for each
/// of the many bounds that change. Here each step is one round.
class HeldLimits {
 public:
  /// @param frames  number of frames in the window.
  HeldLimits(const FitModel& model, std::size_t frames);

  /// State that the steps change, by frame and degree of freedom.
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
  /// Takes the held variables of a frame out of its system, and keeps their rows for release().
  /// Frames count from the window's first one. Entries that an earlier held variable has already
  /// cleared do not count.
  /// @param hessian   rows of `stride` values; the lower triangle.
  /// @param coupling  to the frame before, diagonal.
  /// @param before, after  the terms of the steps to and from the frame; empty: there is none.
  void hold(int frame, double* hessian, double* gradient, int stride, double* coupling,
            std::span<const StepTerm> before, std::span<const StepTerm> after);
  /// Releases the variables that the solved step pulls inside.
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
