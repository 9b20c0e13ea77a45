#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "judge/simulation/physics_model.h"
#include "judge/simulation/reference_track.h"
#include "solve/ik/box_qp.h"

struct mjData_;

namespace retarget {

/// Gains and weights of the tasks of a WholeBodyController, for a robot as large as a G1. A
/// stiffness has the unit 1/s^2, a damping 1/s. A weight multiplies an acceleration, m/s^2 or
/// rad/s^2.
struct ControlGains {
  double com_stiffness = 60.0, com_damping = 16.0, com_weight = 4.0;
  double spin_damping = 4.0, spin_weight = 0.6;
  double root_stiffness = 250.0, root_damping = 32.0, root_weight = 0.85;
  double foot_stiffness = 500.0, foot_damping = 45.0, foot_weight = 5.0;
  double joint_stiffness = 300.0, joint_damping = 35.0, joint_weight = 0.15;
  double torque_weight = 0.02;  ///< Of a torque at its limit.
  double force_weight = 0.05;   ///< Of an edge force as large as the weight.
  double friction = 0.7;        ///< Assumed friction coefficient, below that of the floor.
  double step_reach = 0.25;     ///< Largest step towards the capture point, metres.
  double offset_share = 0.9;    ///< Share of the offset from the reference that a step keeps.
  double follow_time = 0.1;     ///< In which the body follows the standing feet, seconds.
  double flight_reach = 0.15;   ///< Largest vertical shift of the feet in flight, metres.
  /// A foot that touches the floor in the reference's flight stands if its reference stands within
  /// early_time, seconds, and the body is lower than its reference by early_height, metres.
  double early_time = 0.15, early_height = 0.01;
};

/// Result of a control step.
struct ControlStep {
  std::vector<double> torques;  ///< By PhysicsModel::joints, N m (N for slides); within the limits.
  Eigen::VectorXd acceleration;         ///< Planned, by degree of freedom of the physics model.
  std::vector<Eigen::Vector3d> forces;  ///< Planned at `points`, world, N.
  std::vector<int> points;  ///< Indices into PhysicsModel::points: those near the floor.
  bool converged = true;    ///< Whether the QP was solved.
};

/// Tracks a motion by a quadratic program over joint torques t and amounts c of the edges of
/// friction pyramids at the points that are near the floor:
///
///     min  sum_k w_k^2 |T_k(t, c) - wanted_k|^2 + small costs of t and c
///     with |t| <= limits, c >= 0
///
/// T_k are accelerations: of the centre of mass and the rate of the angular momentum, which depend
/// on c alone, of the root's rotation, the feet and the joints. Accelerations are
/// M^-1 (S' t + J' E c - h): the dynamics hold exactly and all constraints are bounds, so BoxQp, the
/// exact solver of the joint limits, applies. The wanted acceleration of a task is the reference's,
/// plus stiffness times error, plus damping times error of velocity.
///
/// Steps keep the balance: a swing foot is shifted by the error of the capture point and stays
/// shifted while it stands. The body then follows its standing feet: the wanted centre of mass has
/// their mean shift, the offset, of which each step takes back a tenth. In flight, the feet keep
/// their height relative to the centre of mass, and a foot that lands too early stays where it
/// landed.
class WholeBodyController {
 public:
  /// @param physics  must outlive this object, as must `robot`.
  /// @param gains    for a robot as large as a G1; scaled by the robot's size.
  WholeBodyController(const PhysicsModel& physics, const Robot& robot,
                      const ControlGains& gains = {});
  ~WholeBodyController();

  /// @param data       state of the physics model; positions and velocities have been evaluated
  ///     (mj_fwdPosition, mj_fwdVelocity).
  /// @param time_step  since the last call, seconds.
  const ControlStep& compute(const ReferenceState& reference, double time_step, mjData_* data);

 private:
  class Tasks;
  struct Foot;

  void find_points(const ReferenceState& reference, double time_step, mjData_* data);
  void build_inputs(mjData_* data);
  void move_feet(const ReferenceState& reference, double time_step, mjData_* data);
  [[nodiscard]] Eigen::Vector3d step_shift(const ReferenceState& reference, mjData_* data) const;
  void follow_feet(double time_step);
  [[nodiscard]] Pose pose_of(const Foot& foot, mjData_* data) const;
  [[nodiscard]] bool is_down(const Foot& foot) const;
  [[nodiscard]] bool bears(int point, const ReferenceState& reference) const;
  void add_centroid(const ReferenceState& reference, mjData_* data);
  void add_root(const ReferenceState& reference, mjData_* data);
  void add_feet(const ReferenceState& reference, mjData_* data);
  void add_joints(const ReferenceState& reference, mjData_* data);
  void solve(const ReferenceState& reference);

  const PhysicsModel& physics_;
  const Robot& robot_;
  ControlGains gains_;
  double weight_, lever_;
  int joint_count_, input_count_ = 0;
  std::vector<Foot> feet_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();  // Of the standing feet; horizontal, metres.
  std::vector<double> scales_;                        // Of the torques.
  std::vector<double> loads_;            // By point: share of the weight that it may bear.
  std::vector<Eigen::Vector3d> places_;  // By active point.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> inputs_, response_;
  Eigen::VectorXd free_, target_;  // Accelerations without inputs; positions of the reference.
  Eigen::VectorXd wanted_rates_, wanted_accelerations_, wanted_positions_;
  std::unique_ptr<Tasks> tasks_;
  BoxQp qp_;
  Eigen::VectorXd lower_, upper_, amounts_;
  ControlStep step_;
};

}  // namespace retarget
