#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "retarget/options.h"
#include "retarget/report.h"
#include "solve/fit/block_chain.h"
#include "solve/fit/contact_places.h"
#include "solve/fit/crossing_terms.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_dynamics.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_damping.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/held_limits.h"
#include "solve/fit/joint_speeds.h"

namespace retarget {

/// Damped Gauss-Newton steps over the frames of a window (docs/fit.md, "The solver"): assembles the
/// block-tridiagonal system of a step, solves it and moves the frames.
class WindowSteps {
 public:
  /// Steps between two updates of the near pairs.
  static constexpr int kPairsEvery = 4;

  /// The kind of a step.
  struct Kind {
    bool move_anchors = false;        ///< Feet that overlap push their anchors apart.
    bool look_for_pairs = false;      ///< Updates the near pairs of all frames.
    double anchor_hold = 1.0;         ///< Factor for the weight of the anchors.
    FitDynamics* dynamics = nullptr;  ///< Adds its rows; null: none.
  };
  /// All state that the steps change, except the status.
  struct State {
    std::vector<double> qpos;
    std::vector<Eigen::Vector2d> anchors;  // Of the phases that the window owns.
    FrameDamping::State damping;
    std::vector<BoundSide> held;
    std::vector<Eigen::Vector2d> anchor_pushes;
    std::vector<NearList> pairs;
  };

  /// Keeps references to the model, options and clip.
  WindowSteps(const FitModel& model, const FitOptions& options, const FitWindow& window,
              FitClip& clip);

  /// Takes one step, and updates the status: failures, the predicted decrease and the number of
  /// steps.
  void take(const Kind& kind, FitStatus& status);
  /// Moves the anchors of the window's contacts to the mean positions of the contacts.
  void place_anchors() { places_.place(window_); }
  /// Factor for the weight of the anchors of frames after a number of steps.
  [[nodiscard]] double hold_after(int steps) const;
  /// Largest sum of squared penetrations of a frame in the last step, including the margin; square
  /// metres.
  [[nodiscard]] double worst_overlap() const { return worst_overlap_; }

  [[nodiscard]] State state() const;
  void restore(const State& state);

  /// See MovingFit::move().
  void move(int begin, int forgotten);
  /// Counts a step of all frames of a moving window.
  void grow_older();

 private:
  std::optional<double> eliminate(const Kind& kind, FitStatus& status);
  double fill_frame(int frame, const Kind& kind);
  void place_frame(int frame, bool look_for_pairs);
  [[nodiscard]] bool is_finite(int t, double cost);
  [[nodiscard]] bool has_finite_solution() const;
  void add_steps(int frame, double* h, double* g);
  void move_base(std::span<const double> x, std::span<double> qpos);
  void apply(int frame, FitDynamics* dynamics);
  [[nodiscard]] bool owns(std::size_t phase) const {
    return window_.owns(clip_.feet.phases[phase]);
  }
  [[nodiscard]] int local(int frame) const { return frame - window_.begin; }

  const FitModel& model_;
  const FitOptions& options_;
  FitWindow window_;
  FitClip& clip_;
  int dofs_;
  bool before_, after_;  // Whether a fixed frame precedes the window, or follows it.
  FrameTerms terms_;
  TreeState pose_;
  TreeState pose_before_;  // Of the frame before, while crossings are found.
  std::optional<CrossingTerms> crossings_;
  JointSpeeds speeds_;
  BlockChain chain_;
  std::vector<NearList> pairs_;  // One per frame.
  // Largest change of a distance for which the pairs stay: half of that after which a shape that
  // was not near may overlap. The other half is for the steps until the next update.
  double pairs_stay_;
  FrameDamping damping_;
  HeldLimits held_;
  std::vector<int> ages_;  // One per frame: number of steps so far; only for a moving window.
  std::vector<StepTerm> steps_before_, steps_after_;  // Step terms before and after the current
                                                      // frame, by dof.
  std::vector<double> applied_;                       // Change applied to the current frame, by
                                                      // dof.
  std::vector<double> given_;  // Configuration with the positions of joints that do not move.
  double worst_overlap_ = 0.0;
  ContactPlaces places_;
};

}  // namespace retarget
