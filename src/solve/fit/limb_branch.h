#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "retarget/options.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/limb_frame.h"
#include "solve/fit/limb_solver.h"

namespace retarget {

/// A limb that follows another branch in some frames of a clip.
struct LimbBranch {
  int begin = 0, end = 0;          ///< Frames [begin, end) that change.
  std::vector<LimbJoints> joints;  ///< By frame.
};

/// Moves a limb of the clip to a branch.
void put_limb(const FitModel& model, const FitLimb& limb, const LimbBranch& branch, FitClip& clip);

/// Searches for other branches of a limb: configurations far from the current one that small steps
/// do not reach, and in which the limb follows its targets better (docs/fit.md).
///
/// Keeps references to its arguments and reads the current state of the clip.
class BranchFinder {
 public:
  BranchFinder(const FitModel& model, const FitOptions& options, const FitClip& clip,
               const FitLimb& limb);

  /// Tracking cost of the limb in a frame.
  [[nodiscard]] double cost(int frame);

  /// Tracking cost that remains after solving the limb alone from its current configuration.
  [[nodiscard]] double stuck_cost(int frame);

  /// Finds another configuration of the limb for a frame. Its cost is less than half of
  /// stuck_cost() and at least `least` lower. Returns nothing if there is none.
  [[nodiscard]] std::optional<LimbJoints> other_configuration(int frame, double least);

  /// Follows a configuration from its frame in both directions and leaves it on either side where
  /// the gain is largest. Returns nothing if no choice lowers the cost.
  [[nodiscard]] std::optional<LimbBranch> follow(int frame, const LimbJoints& joints);

 private:
  // One frame along the branch.
  struct Step {
    LimbJoints own{}, other{};
    double own_cost = 0.0, other_cost = 0.0;  // Cost of all terms of the frame.
  };
  // Extent of the branch in one direction, and its gain.
  struct Reach {
    int frames = 0;   // Number of frames on the other branch.
    int blended = 0;  // Number of blended frames on either side of its end.
    double gain = 0.0;
  };

  [[nodiscard]] double frame_cost();
  [[nodiscard]] double farthest(const LimbJoints& a, const LimbJoints& b) const;
  [[nodiscard]] std::vector<Step> steps(int frame, int direction, const LimbJoints& joints);
  [[nodiscard]] Reach best_reach(int frame, int direction, const std::vector<Step>& steps);
  [[nodiscard]] double blending_cost(int frame, int direction, const std::vector<Step>& steps,
                                     const Reach& reach);
  [[nodiscard]] LimbJoints blended(const Step& step, double share) const;
  [[nodiscard]] std::size_t count() const { return limb_.links.size(); }

  const FitModel& model_;
  const FitOptions& options_;
  const FitClip& clip_;
  const FitLimb& limb_;
  LimbFrame frame_;
  FrameTerms terms_;
  std::vector<double> gradient_, hessian_;
  std::vector<std::uint32_t> pairs_;
};

}  // namespace retarget
