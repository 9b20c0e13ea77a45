#pragma once

#include <Eigen/Core>
#include <vector>

#include "retarget/pose.h"
#include "robot/anatomy/robot_hands.h"
#include "solve/hands/hand_target.h"
#include "solve/ik/box_qp.h"

namespace retarget {

/// Forward kinematics of a robot's hand relative to its palm link. Does not allocate after
/// construction.
class HandPosture {
 public:
  /// @param hand  must outlive this object.
  explicit HandPosture(const RobotHand& hand) : hand_(hand), palm_from_joint_(hand.joints.size()) {}

  /// @param positions  positions of RobotHand::joints, rad or m.
  void set(const Eigen::VectorXd& positions) {
    set_from([&](std::size_t i) { return positions[static_cast<Eigen::Index>(i)]; });
  }
  /// @param variables  values of RobotHand::variables, rad or m.
  void set_variables(const Eigen::VectorXd& variables) {
    set_from([&](std::size_t i) {
      const HandJoint& joint = hand_.joints[i];
      return joint.ratio * variables[joint.variable] + joint.offset;
    });
  }

  /// Pose of a joint in the palm link, metres. @param joint  index into RobotHand::joints.
  [[nodiscard]] const Pose& palm_from_joint(int joint) const {
    return palm_from_joint_[static_cast<std::size_t>(joint)];
  }
  /// Position of a finger's tip in the palm link, metres.
  [[nodiscard]] Eigen::Vector3d tip(const RobotFinger& finger) const {
    return palm_from_joint(finger.joints.back()) * finger.tip;
  }
  /// Point k of a finger's line (its corners, then its tip) in the palm link, metres.
  /// @param joint  receives the joint that carries the point.
  [[nodiscard]] Eigen::Vector3d point(const RobotFinger& finger, int k, int& joint) const;
  /// Distance between the surfaces of the thumb's and a finger's tip, metres; negative if they
  /// overlap.
  /// @pre the hand has a thumb.
  [[nodiscard]] double gap(const RobotFinger& finger) const;
  /// Directions of a finger's parts as unit vectors in the palm axes.
  void directions(const RobotFinger& finger, HandTarget::Parts& parts) const;

 private:
  template <typename Position>
  void set_from(const Position& position) {
    for (std::size_t i = 0; i < hand_.joints.size(); ++i) set_joint(i, position(i));
  }
  void set_joint(std::size_t index, double position);

  const RobotHand& hand_;
  std::vector<Pose> palm_from_joint_;
};

/// Solves for the joint positions of a hand, one frame at a time. Minimises the sum of squares of
///
/// * the direction errors of finger parts, relative to the human's finger at the same fractions of
///   its length;
/// * the errors of the gaps between the thumb's tip and the other tips, relative to the finger's
///   length; the weight grows as the gap shrinks, so that touching fingers touch;
/// * the distances of the joints to the relaxed hand and to the previous frame,
///
/// inside the joint ranges. Takes Levenberg-Marquardt steps, each of which solves a box QP. The
/// terms follow DexPilot (Handa et al. 2020) and AnyTeleop (Qin et al. 2023), with directions
/// instead of vectors.
///
/// A solver belongs to one hand and one thread. It does not allocate after construction.
class HandSolver {
 public:
  /// @param hand   must outlive the solver.
  /// @param lower, upper  ranges of hand.variables, rad or m; may be infinite; lower <= upper.
  HandSolver(const RobotHand& hand, Eigen::VectorXd lower, Eigen::VectorXd upper);

  /// Variables of the relaxed hand.
  [[nodiscard]] const Eigen::VectorXd& relaxed() const { return relaxed_; }

  /// Discards the previous frame, so that the next one is solved from several starts.
  void reset() { has_previous_ = false; }
  /// Solves a frame. @return the values of hand.variables, valid until the next call.
  const Eigen::VectorXd& solve(const HandTarget& target);
  /// The result of the last solve().
  [[nodiscard]] const Eigen::VectorXd& solution() const { return current_; }
  /// Whether the last solve() met non-finite values. It then returned the previous frame or the
  /// relaxed hand.
  [[nodiscard]] bool has_failed() const { return failed_; }

  /// Computes the cost (half the sum of squares), its gradient and its Gauss-Newton matrix.
  /// @param previous  variables of the previous frame; null for the first frame.
  double evaluate(const HandTarget& target, const Eigen::VectorXd& variables,
                  const Eigen::VectorXd* previous, Eigen::VectorXd& gradient,
                  Eigen::MatrixXd& matrix);

 private:
  struct Descent;
  using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  void add_jacobian(int joint, const Eigen::Vector3d& point, double sign);
  void add_rows(const Eigen::Vector3d& residual, double weight, Eigen::VectorXd& gradient,
                Eigen::MatrixXd& matrix);
  double add_directions(const HandTarget& target, std::size_t index, Eigen::VectorXd& gradient,
                        Eigen::MatrixXd& matrix);
  double add_gap(const HandTarget& target, const RobotFinger& finger, Eigen::VectorXd& gradient,
                 Eigen::MatrixXd& matrix);
  // @return the cost; NaN if a value is not finite.
  double descend(const HandTarget& target, const Eigen::VectorXd* previous, int steps,
                 Eigen::VectorXd& variables);
  // Solves from several starts and keeps the best result.
  // @return the cost; if it is not finite, the result is the relaxed hand.
  double search(const HandTarget& target, Eigen::VectorXd& variables);

  const RobotHand& hand_;
  HandMatch match_;
  Eigen::VectorXd lower_, upper_, range_, relaxed_, open_;
  HandPosture posture_;
  PointJacobian jacobian_;
  Eigen::VectorXd current_, previous_, tried_, best_, tried_gradient_;
  Eigen::MatrixXd tried_matrix_;
  DenseLeastSquares system_;
  bool has_previous_ = false, failed_ = false;
};

}  // namespace retarget
