#pragma once

#include <Eigen/Core>

#include "anatomy/robot_hands.h"
#include "hands/hand_posture.h"
#include "hands/hand_target.h"
#include "ik/box_qp.h"

namespace retarget {

/// Weights of the residuals of a hand; they enter the cost squared.
struct HandWeights {
  double direction = 1.0;         ///< Of a whole finger, per unit of a unit vector's error.
  double thumb_direction = 0.35;  ///< A robot's thumb stands elsewhere in the palm than a human's.
  double gap = 0.4;               ///< Of fingers that are far from the thumb, per finger's length.
  double touch = 8.0;             ///< Of those that touch it.
  double rest = 0.07;             ///< To the relaxed hand, per range of a joint.
  double still = 0.15;            ///< To the frame before, per range of a joint.
};

/// Finds the joints of a hand, one frame at a time: the least sum of squares of
///
/// * finger parts that point elsewhere than the human's, at the same shares of the finger's length;
/// * tips that are nearer to the thumb's or farther from it than the human's are, by the fingers' lengths;
///   the nearer they are, the more this counts, so that fingers that touch do;
/// * joints away from the relaxed hand and from the frame before,
///
/// inside the joints' ranges: Gauss-Newton steps with Levenberg's damping, each a box QP. The terms are those
/// of DexPilot (Handa et al. 2020) and AnyTeleop (Qin et al. 2023) with directions for vectors.
///
/// One solver belongs to one hand and one thread; nothing is allocated after construction.
class HandSolver {
 public:
  /// @param hand   outlives the solver.
  /// @param lower  ranges of hand.variables, rad or m; finite or not, lower <= upper.
  HandSolver(const RobotHand& hand, Eigen::VectorXd lower, Eigen::VectorXd upper,
             const HandWeights& weights = {});

  [[nodiscard]] int variable_count() const { return static_cast<int>(lower_.size()); }
  /// Of the hand that does nothing.
  [[nodiscard]] const Eigen::VectorXd& relaxed() const { return relaxed_; }

  /// Forgets the frame before: the next one is looked for from several starts.
  void reset() { has_previous_ = false; }
  /// Solves a frame; the variables stay valid until the next one.
  const Eigen::VectorXd& solve(const HandTarget& target);

  /// The cost of variables, half the sum of squares, and its gradient and Gauss-Newton matrix.
  /// @param previous  the frame before; nullptr: there is none.
  double evaluate(const HandTarget& target, const Eigen::VectorXd& variables,
                  const Eigen::VectorXd* previous, Eigen::VectorXd& gradient,
                  Eigen::MatrixXd& matrix);

 private:
  using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  void add_jacobian(int joint, const Eigen::Vector3d& point, double sign);
  void add_rows(const Eigen::Vector3d& residual, double weight, Eigen::VectorXd& gradient,
                Eigen::MatrixXd& matrix);
  double add_directions(const HandTarget& target, std::size_t index, Eigen::VectorXd& gradient,
                        Eigen::MatrixXd& matrix);
  double add_gap(const HandTarget& target, const RobotFinger& finger, Eigen::VectorXd& gradient,
                 Eigen::MatrixXd& matrix);
  double descend(const HandTarget& target, const Eigen::VectorXd* previous, int steps,
                 Eigen::VectorXd& variables);
  /// The best of several starts.
  void search(const HandTarget& target, Eigen::VectorXd& variables);

  const RobotHand& hand_;
  HandMatch match_;
  HandWeights weights_;
  Eigen::VectorXd lower_, upper_, range_, relaxed_, open_;
  HandPosture posture_;
  PointJacobian jacobian_;
  Eigen::VectorXd current_, previous_, tried_, best_, step_, step_lower_, step_upper_;
  Eigen::VectorXd gradient_, tried_gradient_;
  Eigen::MatrixXd matrix_, tried_matrix_, damped_;
  BoxQp qp_;
  bool has_previous_ = false;
};

}  // namespace retarget
