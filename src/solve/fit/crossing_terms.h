#pragma once

#include <cstdint>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/half_way.h"

namespace retarget {

/// The self-collision terms half-way between the frames of a window, for shapes that pass through
/// each other between two frames. Keeps references to the model and the clip.
class CrossingTerms {
 public:
  CrossingTerms(const FitModel& model, const FitClip& clip, const FitWindow& window);

  /// A pose, and the pairs that are near in it, ascending.
  struct PoseWithPairs {
    const TreeState& pose;
    const std::vector<std::uint32_t>& pairs;
  };

  /// Call it before the frames of a step of the solver, which changes the clip.
  void begin_step() { half_way_to_ = -1; }

  /// Finds the pairs that pass through each other in the step to a frame, among those that are near
  /// in one of its frames. They stay listed, because the term must hold them apart.
  void find(int frame, const PoseWithPairs& before, const PoseWithPairs& now);

  /// Adds the terms half-way to the frames before and after.
  ///
  /// Such a term depends on two frames: its residual is r + J (a + b) / 2, where a and b are their
  /// changes. The sum of half the squares of r + J a and r + J b is never less, and has the same
  /// value and gradient at a = b = 0. It couples no frames.
  /// @param g, h, stride, costs  see FrameTerms::add_crossings().
  void add(int frame, FrameTerms& terms, double* g, double* h, int stride, TermCosts& costs);

 private:
  void pose_half_way(int frame);
  [[nodiscard]] std::vector<std::uint32_t>& crossings_to(int frame);

  const FitModel& model_;
  const FitClip& clip_;
  const FitWindow& window_;
  HalfWay half_way_;
  int half_way_to_ = -1;  // Frame to which half_way_ leads in this step; -1: none.
  // By frame: pairs that overlap, or nearly so, half-way from the frame before.
  std::vector<std::vector<std::uint32_t>> crossings_;
  std::vector<std::uint32_t> candidates_;
};

}  // namespace retarget
