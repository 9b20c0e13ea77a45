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

/// A path of a limb on another branch of its inverse kinematics, in an interval of a clip.
struct LimbBranch {
  int begin = 0, end = 0;          ///< Frames [begin, end) that change.
  std::vector<LimbJoints> joints;  ///< Joint positions by frame.
};

/// Writes the joint positions of the branch into the clip.
void put_limb(const FitModel& model, const FitLimb& limb, const LimbBranch& branch, FitClip& clip);

/// Searches for other branches of a limb's inverse kinematics: configurations that small steps from
/// the current one do not reach, and in which the limb follows its targets better (docs/fit.md).
///
/// Keeps references to its arguments and reads the current state of the clip.
class BranchFinder {
 public:
  BranchFinder(const FitModel& model, const FitOptions& options, const FitClip& clip,
               const FitLimb& limb);

  /// Tracking cost of the limb in a frame.
  [[nodiscard]] double cost(int frame);

  /// Tracking cost of the local minimum that a solve of the limb alone reaches from the current
  /// configuration.
  [[nodiscard]] double stuck_cost(int frame);

  /// Searches for a configuration of the limb in a frame whose tracking cost is less than half of
  /// stuck_cost() and at least `least` below it. Empty if the search finds none.
  [[nodiscard]] std::optional<LimbJoints> other_configuration(int frame, double least);

  /// Follows the branch of a configuration from its frame in both directions. On either side,
  /// leaves it where that lowers the cost most. Empty if no branch lowers the cost.
  [[nodiscard]] std::optional<LimbBranch> follow(int frame, const LimbJoints& joints);

 private:
  // One frame along the branch.
  struct Step {
    LimbJoints own{}, other{};
    double own_cost = 0.0, other_cost = 0.0;  // Cost of all terms of the frame.
  };
  // Extent of the branch in one direction, and its gain.
  struct Reach {
    int frames = 0;     // Number of frames on the other branch.
    int blended = 0;    // Number of blended frames on either side of its end.
    double gain = 0.0;  // Cost reduction.
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
