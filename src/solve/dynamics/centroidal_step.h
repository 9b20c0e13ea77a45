#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/math/banded_system.h"
#include "solve/dynamics/force_cone.h"

namespace retarget {

/// A frame of a CentroidalStep. Forces are in units of the weight W, torques in units of W times a
/// length l (CentroidalScale::length).
struct CentroidalFrame {
  Vector6d needed = Vector6d::Zero();  ///< Required wrench about the centre of mass.
  ForceCone cone;                      ///< Wrenches that contacts can exert about the same point.
  /// Sum of earlier changes: of the centre of mass, m, and of the angular quasi-coordinate, kg m^2.
  Vector6d moved = Vector6d::Zero();
  /// Trust in the cone, 0 to 1: factor for the weight of the unexplained wrench.
  double trust = 1.0;
  /// Norm up to which an unexplained wrench has no cost.
  double dead_zone = kDeadZone;

  /// Three fifths of DynamicsSample's threshold for a bad sample. Controllers do not notice smaller
  /// unexplained wrenches, so the body need not move for them.
  static constexpr double kDeadZone = 0.06;
};

/// Units of a CentroidalStep.
struct CentroidalScale {
  double mass = 1.0;               ///< Kilograms.
  double length = 0.3;             ///< The length l, metres.
  double frame_time = 1.0 / 30.0;  ///< Seconds.
};

/// Finds the smallest change x of the paths of a motion's centre of mass and angular
/// quasi-coordinate with which its contacts can supply the required wrench w (docs/dynamics.md):
///
///     min over b   rho/2 sum dist^2(w + [x_lin'' / g; (x_ang'' + x_lin x F) / (W l)], cone)
///                  + 1/2 sum |x + moved|^2 + |x''|^2, each weighted
///
/// x is a cubic spline with coefficients b, so that x'' at the frames is b's second difference. F
/// is the required force. Only the part of a distance beyond the frame's dead zone has a cost. The
/// solver is a semismooth Newton method with a line search on a banded system. The first and last
/// frames stay fixed.
class CentroidalStep {
 public:
  /// Computes unexplained() for the current motion. Call it before solve().
  ///
  /// If frames are less than 1/30 s apart, replaces `needed` by its triangular mean over that time.
  /// The forces of a foot's touch-down within this time are irrelevant for the motion of the whole
  /// body, but at 120 frames per second they would dominate the cost. At 30 frames per second or
  /// fewer, the mean changes nothing.
  void find_unexplained(std::vector<CentroidalFrame>& frames, const CentroidalScale& scale);
  /// Recomputes unexplained() after the cones changed, without averaging `needed` again.
  void project_needed(std::vector<CentroidalFrame>& frames);
  /// @return x by frame, metres and kg m^2; zeros if has_failed().
  std::vector<Vector6d> solve(std::vector<CentroidalFrame>& frames, const CentroidalScale& scale,
                              int iterations);
  /// Whether solve() encountered non-finite values. It takes no step with them.
  [[nodiscard]] bool has_failed() const { return failed_; }
  /// Second time derivative of the result of solve() by frame, m/s^2 and kg m^2/s^2.
  [[nodiscard]] const std::vector<Vector6d>& accelerations() const { return accelerations_; }
  /// Part of the required wrench, by frame, that the contacts cannot supply in the motion before
  /// solve().
  [[nodiscard]] const std::vector<Vector6d>& unexplained() const { return unexplained_before_; }

 private:
  struct Descent;
  void begin(const std::vector<CentroidalFrame>& frames, const CentroidalScale& scale);
  double evaluate(std::vector<CentroidalFrame>& frames, const std::vector<Vector6d>& b);
  void assemble(const std::vector<CentroidalFrame>& frames, const std::vector<Vector6d>& b);
  void add_block(std::size_t row, std::size_t column, const Matrix6d& block);
  void add_diagonals(std::size_t frame, const Vector6d& side_pull, const Vector6d& middle_pull,
                     const Vector6d& moved, const std::vector<Vector6d>& b);
  [[nodiscard]] static Vector6d value(const std::vector<Vector6d>& b, std::size_t t);
  [[nodiscard]] static Vector6d second(const std::vector<Vector6d>& b, std::size_t t);

  bool failed_ = false;
  CentroidalScale scale_;
  Vector6d position_weight_, acceleration_weight_;  // Squared weights.
  Vector6d force_per_acceleration_;
  // By frame: derivative of the required wrench with respect to x.
  std::vector<Matrix6d> coupling_;
  BandedSystem system_;
  // By frame, at the iterate of the last evaluate(): unexplained wrench, and its derivative.
  std::vector<Vector6d> rest_;
  std::vector<Matrix6d> complement_;
  std::vector<Vector6d> unexplained_before_, accelerations_;
  ConeProjector projector_;
};

}  // namespace retarget
