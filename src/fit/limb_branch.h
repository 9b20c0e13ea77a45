#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "fit/fit_clip.h"
#include "fit/fit_model.h"
#include "fit/frame_terms.h"
#include "fit/limb_solver.h"
#include "retarget/options.h"
#include "robot/kinematic_tree.h"

namespace retarget {

/// A limb on another branch for some frames of a clip.
struct LimbBranch {
  int begin = 0, end = 0;          ///< Frames [begin, end) that change.
  std::vector<LimbJoints> joints;  ///< By frame.
};

/// Looks for other branches of a limb: configurations far from its own from which no small steps lead
/// there, and in which it follows its targets better (docs/fit.md).
///
/// Keeps references to all that it is made from; reads the clip as it is at the time.
class BranchFinder {
 public:
  BranchFinder(const FitModel& model, const FitOptions& options, const FitClip& clip,
               const FitLimb& limb);

  /// What tracking costs on the limb in a frame.
  [[nodiscard]] double cost(int frame);

  /// What is left of it where the limb alone goes on from where it is.
  [[nodiscard]] double stuck_cost(int frame);

  /// Another configuration of the limb for a frame that costs less than half as much as any near its
  /// own, and by `least` at least; nothing: there is none.
  [[nodiscard]] std::optional<LimbJoints> other_configuration(int frame, double least);

  /// Follows a configuration from its frame both ways, and leaves it on either side where that is
  /// worth most. Nothing: nowhere does it pay.
  [[nodiscard]] std::optional<LimbBranch> follow(int frame, const LimbJoints& joints);

 private:
  // a frame on the way
  struct Step {
    LimbJoints own{}, other{};
    double own_cost = 0.0, other_cost = 0.0;  // of the whole frame
  };
  // how far to go one way
  struct Reach {
    int frames = 0;   // on the other branch
    int blended = 0;  // on either side of where it ends
    double gain = 0.0;
  };

  void set_frame(int frame);
  void place(const LimbJoints& joints);
  [[nodiscard]] LimbJoints placed() const;
  [[nodiscard]] double frame_cost();
  [[nodiscard]] double farthest(const LimbJoints& a, const LimbJoints& b) const;
  [[nodiscard]] LimbRange within_reach(const LimbJoints& joints) const;
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
  LimbSolver solver_;
  FrameTerms terms_;
  TreeState pose_;            // of qpos_,
  std::vector<double> qpos_;  // the frame's but for the limb
  int frame_ = 0;
  std::vector<double> gradient_, hessian_;
  std::vector<std::uint32_t> pairs_;
};

}  // namespace retarget
