#pragma once

#include <Eigen/Core>
#include <vector>

#include "dynamics/force_cone.h"

namespace retarget {

/// A frame of a CentroidalStep. Forces in terms of the weight W, torques of W times a length l.
struct CentroidalFrame {
  Vector6d needed = Vector6d::Zero();  ///< Wrench about the centre of mass.
  ForceCone cone;                      ///< What contacts can exert, about the same point.
  /// What was moved before: of the centre of mass, m, and of the angular quasi-coordinate, kg m^2.
  Vector6d moved = Vector6d::Zero();
  double trust = 1.0;  ///< In what the cone says, 0 to 1: factor to the weight of what is missing.
};

struct CentroidalScale {
  double mass = 1.0;               ///< kg
  double length = 0.3;             ///< l, m
  double frame_time = 1.0 / 30.0;  ///< s
};

/// How far the centre of mass and the angular momentum of a motion have to be moved for its contacts
/// to supply what it needs, as little as possible (docs/dynamics.md):
///
///     min over b   rho/2 sum dist^2(w + [x_lin'' / g; (x_ang'' + x_lin x F) / (W l)], cone)
///                  + 1/2 sum |x + moved|^2 + |x''|^2, each weighted
///
/// x cubic splines with coefficients b, so that x'' at the frames is b's second difference; of dist
/// what is below 1 % of the weight counts for nothing. Damped semismooth Newton on a banded system;
/// the first and the last frame stay.
class CentroidalStep {
 public:
  /// What contacts cannot supply of what is needed as it is; see unexplained(). Before solve().
  ///
  /// Where frames are denser than a thirtieth of a second, `needed` becomes its mean over that time (a
  /// triangle's): how feet touch down within it is no matter of the whole body's movement, and at 120
  /// frames a second it would drown that. At 30 and fewer nothing changes.
  void find_unexplained(std::vector<CentroidalFrame>& frames, const CentroidalScale& scale);
  /// @return by frame: x, metres and kg m^2.
  std::vector<Vector6d> solve(std::vector<CentroidalFrame>& frames, const CentroidalScale& scale,
                              int iterations);
  /// Of what solve returned, by frame: its second derivative, per second squared.
  [[nodiscard]] const std::vector<Vector6d>& accelerations() const { return accelerations_; }
  /// By frame: how much of what was needed the contacts could not supply before the move.
  [[nodiscard]] const std::vector<Vector6d>& unexplained() const { return unexplained_before_; }

 private:
  void begin(const std::vector<CentroidalFrame>& frames, const CentroidalScale& scale);
  double evaluate(std::vector<CentroidalFrame>& frames, const std::vector<Vector6d>& b);
  void assemble(const std::vector<CentroidalFrame>& frames, const std::vector<Vector6d>& b);
  void add_block(std::size_t row, std::size_t column, const Matrix6d& block);
  void add_diagonals(std::size_t frame, const Vector6d& side_pull, const Vector6d& middle_pull,
                     const Vector6d& moved, const std::vector<Vector6d>& b);
  bool step(std::vector<Vector6d>& direction);
  [[nodiscard]] static Vector6d value(const std::vector<Vector6d>& b, std::size_t t);
  [[nodiscard]] static Vector6d second(const std::vector<Vector6d>& b, std::size_t t);

  CentroidalScale scale_;
  Vector6d position_weight_, acceleration_weight_;  // squared
  Vector6d force_per_acceleration_;
  std::vector<Matrix6d> coupling_;  // by frame: needed wrench per x
  std::vector<double> band_, right_;
  std::vector<Vector6d> rest_;  // by frame, where evaluate was called last
  std::vector<Matrix6d> complement_;
  std::vector<Vector6d> unexplained_before_, accelerations_;
  ConeProjector projector_;
};

}  // namespace retarget
