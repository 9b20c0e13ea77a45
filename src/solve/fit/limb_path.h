#pragma once

#include <optional>
#include <span>
#include <vector>

#include "retarget/options.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/limb_branch.h"
#include "solve/fit/limb_frame.h"
#include "solve/fit/limb_solver.h"

namespace retarget {

/// A configuration of a limb in a frame.
struct LimbPlace {
  int frame = 0;
  LimbJoints joints{};
};

/// Finds the best path of a limb in an interval over all branches of its inverse kinematics, by
/// dynamic programming over a grid of positions of the limb's first joint (docs/fit.md).
///
/// Keeps references to its arguments and reads the current state of the clip.
class LimbPathFinder {
 public:
  LimbPathFinder(const FitModel& model, const FitOptions& options, const FitClip& clip,
                 const FitLimb& limb);

  /// Searches for a path from the current configuration of frame `begin` to that of frame `end` -
  /// 1; at the ends of the clip, from or to any configuration. Empty if no path is clearly better
  /// than the current one.
  /// @param others  configurations in frames of the interval, in order of time, on branches that
  ///     small steps from the current configuration do not reach.
  [[nodiscard]] std::optional<LimbBranch> find(int begin, int end,
                                               std::span<const LimbPlace> others);

 private:
  // A configuration of the limb in a frame, and the best path to it.
  struct Node {
    LimbJoints joints{};
    double tracking = 0.0;  // Tracking cost, times the number of frames since the last layer.
    double total = 0.0;     // Cost of the best path up to this node.
    int before = 0;         // Index of the previous node on this path.
  };
  using Layer = std::vector<Node>;

  [[nodiscard]] Node own_node(int frame, int frames);
  [[nodiscard]] Node solved(const LimbJoints& start, int position, LimbRange range, int frames);
  [[nodiscard]] Layer solve_layer(int frame, const Layer& before, const Layer& other, int frames);
  [[nodiscard]] Layer solve_grid(int frame, const LimbJoints& start, int frames);
  [[nodiscard]] std::vector<Layer> follow(std::span<const LimbPlace> others,
                                          const std::vector<int>& frames);
  [[nodiscard]] double move_cost(const LimbJoints& from, const LimbJoints& to, int frames) const;
  void connect(const Layer& before, Layer& layer, int frames) const;
  [[nodiscard]] LimbBranch best_path(const std::vector<Layer>& layers,
                                     const std::vector<int>& frames) const;
  [[nodiscard]] double position(int index) const { return lowest_ + index * spacing_; }
  [[nodiscard]] std::size_t count() const { return max_speed_.size(); }

  const FitOptions& options_;
  const double frame_time_;
  const int frame_count_;
  LimbFrame frame_;
  std::vector<double> max_speed_;        // One per joint, rad/s or m/s.
  double lowest_ = 0.0, spacing_ = 0.0;  // Grid of the first joint, rad.
  int positions_ = 1;                    // Number of grid points.
};

}  // namespace retarget
