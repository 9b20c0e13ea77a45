#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/math/banded_system.h"
#include "solve/dynamics/force_cone.h"

namespace retarget {

/// A frame of a CentroidalStep. Forces are in units of the weight W, torques in units of W times a
/// length l.
struct CentroidalFrame {
  Vector6d needed = Vector6d::Zero();  ///< Needed wrench about the centre of mass.
  ForceCone cone;                      ///< Wrenches that contacts can exert about the same point.
  /// Earlier displacement: of the centre of mass, m, and of the angular quasi-coordinate, kg m^2.
  Vector6d moved = Vector6d::Zero();
  /// Trust in the cone, 0 to 1: factor for the weight of the missing wrench.
  double trust = 1.0;
  /// Size below which a missing wrench has no effect.
  double dead_zone = kDeadZone;

  /// Three fifths of what the metrics call bad: a smaller missing wrench would move the body where no
  /// controller would notice.
  static constexpr double kDeadZone = 0.06;
};

struct CentroidalScale {
  double mass = 1.0;               ///< Kilograms.
  double length = 0.3;             ///< The length l, metres.
  double frame_time = 1.0 / 30.0;  ///< Seconds.
};

/// Finds the smallest change of a motion's centre of mass and angular momentum with which its
/// contacts can supply the needed wrench (docs/dynamics.md):
///
///     min over b   rho/2 sum dist^2(w + [x_lin'' / g; (x_ang'' + x_lin x F) / (W l)], cone)
///                  + 1/2 sum |x + moved|^2 + |x''|^2, each weighted
///
/// x is a cubic spline with coefficients b, so x'' at the frames is b's second difference.
/// Distances inside the dead zone of a frame do not count. Solved by a damped semismooth Newton method on a
/// banded system. The first and last frames stay fixed.
class CentroidalStep {
 public:
  /// Computes the part of the needed wrench that contacts cannot supply in the current motion; see
  /// unexplained(). Call it before solve().
  ///
  /// If frames are less than 1/30 s apart, replaces `needed` by its triangular mean over that time.
  /// The details of a foot's touch-down within this time do not concern the movement of the whole
  /// body, but at 120 frames per second they would dominate it. At 30 frames per second or fewer,
  /// nothing changes.
  void find_unexplained(std::vector<CentroidalFrame>& frames, const CentroidalScale& scale);
  /// The same after the cones changed, with `needed` as it is.
  void project_needed(std::vector<CentroidalFrame>& frames);
  /// @return x by frame, metres and kg m^2; zeros if has_failed().
  std::vector<Vector6d> solve(std::vector<CentroidalFrame>& frames, const CentroidalScale& scale,
                              int iterations);
  /// Whether solve() encountered non-finite values. It takes no step with them.
  [[nodiscard]] bool has_failed() const { return failed_; }
  /// Second derivative of the result of solve() by frame, per second squared.
  [[nodiscard]] const std::vector<Vector6d>& accelerations() const { return accelerations_; }
  /// By frame: part of the needed wrench that contacts could not supply before the change.
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
  std::vector<Matrix6d> coupling_;  // By frame: change of the needed wrench per x.
  BandedSystem system_;
  std::vector<Vector6d> rest_;  // By frame, at the point of the last evaluate().
  std::vector<Matrix6d> complement_;
  std::vector<Vector6d> unexplained_before_, accelerations_;
  ConeProjector projector_;
};

}  // namespace retarget
