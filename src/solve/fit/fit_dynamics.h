#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "retarget/options.h"
#include "solve/dynamics/centroidal_map.h"
#include "solve/dynamics/centroidal_step.h"
#include "solve/dynamics/inverse_dynamics.h"
#include "solve/dynamics/motion_spline.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/window_contacts.h"

namespace retarget {

/// The dynamics terms in the last steps of a fit, for one window. Where the contacts cannot supply
/// the required forces, it changes the paths of the centre of mass and of the angular
/// quasi-coordinate as little as necessary (CentroidalStep). Six rows per frame make the robot
/// follow these paths (docs/dynamics.md).
class FitDynamics {
 public:
  FitDynamics(const FitModel& model, const FitOptions& options, const FitWindow& window,
              const FitClip& clip);

  /// Whether the model has mass and feet.
  [[nodiscard]] static bool possible(const FitModel& model) {
    return model.inertias.mass > 0.0 && !model.feet.empty();
  }

  /// Detects the contacts of the clip and estimates how far they explain its forces (trust). Call
  /// it first.
  /// @return measure(clip); NaN if values are too large for the computation.
  double begin(const FitClip& clip);
  /// Whether there is a frame in which the contacts cannot supply the required forces. Call it
  /// after begin().
  [[nodiscard]] bool is_needed() const;
  /// Mean over the frames of the unexplained wrench of the current clip, in body weights. The value
  /// of a frame is at most 1 and is scaled by the trust in its contacts.
  double measure(const FitClip& clip);
  /// Whether to keep the steps after which measure() returned `now`, from `before`. The goals of the
  /// dynamics terms are wrong where unknown supports, such as uneven ground, carry the body: in more
  /// than 55 % of the frames, contacts are unknown or the unexplained wrench is above 10 % of the
  /// weight.
  [[nodiscard]] bool has_helped(double before, double now) const;
  /// Number of frames without trust: their contacts are unknown, so the dynamics terms are off.
  [[nodiscard]] int distrusted_frames() const;
  /// Computes the goals of the rows from the current clip. Call it before each step that uses
  /// dynamics.
  /// @return false if a value is not finite.
  [[nodiscard]] bool plan(const FitClip& clip);
  /// Adds the rows of a frame to the linear system of a step.
  /// @param gradient, hessian  see FrameTerms::assemble.
  /// @return the cost of the rows.
  double add_rows(int frame, const TreeState& pose, double* gradient, double* hessian, int stride);
  /// Updates the angular quasi-coordinate after a step.
  /// @param step  the change that the step applied to the frame, by degree of freedom.
  void moved(int frame, std::span<const double> step);

 private:
  void read_frames(const FitClip& clip);
  [[nodiscard]] double missing_share() const;
  [[nodiscard]] bool is_mostly_unexplained() const;
  [[nodiscard]] int frames_within(double seconds) const;
  void read_frame(const MotionState& state, int t, const FitClip& clip);
  [[nodiscard]] double beyond_ankles(int t);
  void find_overloaded_ankles();
  void find_reach(int t);
  [[nodiscard]] double load_on(int t, int foot) const;
  void fill_cone(int t, Eigen::Vector3d FitContactPlace::*towards, double share);
  void find_trust();
  void restrain(std::vector<Vector6d>& moves);

  const FitModel& model_;
  const FitOptions& options_;
  const FitWindow& window_;
  int count_;  // Number of frames in the window.
  CentroidalScale scale_;
  WindowContacts contacts_;
  InverseDynamics inverse_;
  CentroidalMap map_;
  TreeState pose_;
  CentroidalStep step_;
  std::vector<CentroidalFrame> frames_;
  std::vector<Eigen::Vector3d> headings_;      // Forward direction of the base, by frame.
  std::vector<Eigen::Vector3d> sole_normals_;  // One per foot, in the axes of its link.
  // By link, N m: largest torque in frames with overloaded ankles.
  std::vector<double> ankle_torques_;
  ConeProjector projector_;
  std::vector<double> overload_;  // One per frame, 0 to 1: share of to_reach that applies.
  std::vector<Eigen::Vector3d> com_, first_com_;  // Now and in begin(); world, metres.
  // Goal of the centre of mass (world, metres) and remaining change of the angular
  // quasi-coordinate.
  std::vector<Vector6d> goals_;
  std::vector<double> rest_before_, share_;             // One per frame; see restrain().
  Eigen::Matrix<double, 3, Eigen::Dynamic> spin_rows_;  // Angular rows, frame after frame.
  bool begun_ = false, planned_ = false;
};

}  // namespace retarget
