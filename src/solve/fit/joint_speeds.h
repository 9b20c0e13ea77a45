#pragma once

#include <span>
#include <vector>

#include "base/math/banded_system.h"
#include "retarget/options.h"
#include "solve/fit/fit_clip.h"
#include "solve/fit/fit_model.h"
#include "solve/fit/frame_terms.h"
#include "solve/fit/limb_solver.h"
#include "solve/fit/root_reference.h"

namespace retarget {

/// Quadratic model of half the cost of a step from one frame to the next, for one degree of
/// freedom: weight/2 d^2 + force d + constant, where d is the change of the step.
struct StepTerm {
  double weight = 0.0;
  double force = 0.0;
};

/// The smoothness and speed terms, which couple consecutive frames. They couple no two degrees of
/// freedom:
///
///     (w / dt)^2 |v - s|^2                   smoothness
///     (u / dt)^2 max(0, |v| - limit dt)^2    speed
///
/// v is the sequence of steps between frames, s the smoothed sequence that minimises
/// |v - s|^2 + (T / dt)^2 |D s|^2, and D takes differences of consecutive entries. For the root
/// position, the first term subtracts smoothness_root_reference times RootReference::step() from v,
/// so that only deviations from the target's accelerations have a cost.
///
/// update() recomputes s before every iteration. With L = D'D and l = (T / dt)^2, eliminating s
/// turns the first term into (w / dt)^2 v' l L (1 + l L)^-1 v. For small T, this penalises
/// accelerations with the weight (w T)^2. Its matrix couples distant frames. No eigenvalue of L
/// exceeds 4, so (w / dt)^2 4 l / (1 + 4 l) times the identity is an upper bound of the matrix. The
/// bound couples only consecutive frames, and with it every step lowers the cost (majorisation).
/// The root's position uses less than the bound (over-relaxation).
///
/// For the joints of arms and legs, s minimises |v - s|^2 + (T / dt)^4 |D D s|^2, with another T.
/// The term then penalises changes of acceleration, and a limb may turn round as fast as the
/// human's. Touchdown and lift-off of a limb are such changes, and a limb that carries the body
/// must not tremble: while a part of a limb is in contact, its differences are of first order as
/// above.
///
/// In a scene, the terms of all joints are larger near contacts with its bodies, by the factors
/// F = diag(f) of FitScene::joint_smoothness: s minimises (v - s)' F (v - s) + s' K s, where K
/// weights each difference with the smallest factor of its steps. Eliminating s leaves the matrix
/// (F^-1 + K^-1)^-1. The diagonal matrix C of the absolute row sums of K bounds K, so
/// (F^-1 + C^-1)^-1 bounds this matrix.
class JointSpeeds {
 public:
  /// @param clip          for its frame time and scene.
  /// @param targets_stay  all updates read the same frames, and their targets do not change.
  JointSpeeds(const FitModel& model, const FitOptions& options, const FitClip& clip,
              bool targets_stay = false);

  /// Reads the steps of frames [first, last).
  void update(const FitModel& model, const FitClip& clip, int first, int last);

  /// Terms of the step from `frame` to the next one. update() must have read this step.
  void terms(int frame, std::span<StepTerm> terms) const;
  void add_costs(int frame, TermCosts& costs) const;

 private:
  // The smoothing of one limb, or of all joints that belong to none.
  struct Limb {
    std::vector<int> dofs;
    std::vector<std::size_t> feet, supports;  // Of the model, in this limb.
    // Frames before and after a contact in which the limb counts as in contact.
    int margin = 0;
    bool second_order = false;      // Away from contacts.
    std::vector<double> stiffness;  // One per step, like stiffness_.
  };

  [[nodiscard]] static Limb limb_of(const FitModel& model, const FitLimb& limb, double frame_time);
  [[nodiscard]] static bool touches(const Limb& limb, const FitClip& clip, int frame);
  void add_joints_of_no_limb(const FitModel& model);
  void subtract_root_reference(const FitClip& clip, int count);
  void update_factors(const FitScene& scene, int count);
  void smooth(Limb& limb, const FitClip& clip, int count);
  void add_differences(const Limb& limb, const FitClip& clip, int count);
  // Factor of the joints' terms for a step.
  [[nodiscard]] double factor(int step) const {
    return scene_factors_.empty() ? 1.0 : scene_factors_[static_cast<std::size_t>(step)];
  }

  [[nodiscard]] const double* row(const std::vector<double>& values, int frame) const {
    return values.data() + static_cast<std::size_t>(frame - first_) * smooth_weight_.size();
  }

  RootReference root_;
  bool targets_stay_;
  double root_share_;                  // Factor for the reference's steps.
  std::vector<double> smooth_weight_;  // (w / dt)^2, by dof.
  std::vector<double> soft_step_;      // By dof: step at which the speed term sets in.
  double speed_weight_;                // (u / dt)^2.
  double smoothing_;                   // (T / dt)^2.
  double stiffness_;                   // 4 l / (1 + 4 l).
  double root_stiffness_;              // Of the root's position.
  double limb_smoothing_;              // (T / dt)^4 of limbs.
  std::vector<Limb> limbs_;
  PentadiagonalMatrix smoothness_;
  int first_ = 0;
  std::vector<double> steps_, smooth_, factors_;
  std::vector<Eigen::Vector3d> root_steps_;  // Of root_, by step.
  // Of the joints' terms by step, and steps_ times these factors; only in scenes.
  std::vector<double> scene_factors_, factored_steps_;
};

}  // namespace retarget
