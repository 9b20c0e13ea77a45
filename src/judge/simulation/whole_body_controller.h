#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "judge/simulation/physics_model.h"
#include "judge/simulation/reference_track.h"
#include "solve/ik/box_qp.h"

struct mjData_;

namespace retarget {

/// Gains and weights of the tasks of a WholeBodyController, for a robot of a G1's size. Stiffnesses
/// are in 1/s^2, dampings in 1/s. A weight multiplies an acceleration residual in m/s^2 or rad/s^2.
struct ControlGains {
  double com_stiffness = 60.0, com_damping = 16.0, com_weight = 4.0;
  double spin_damping = 4.0, spin_weight = 0.6;
  double root_stiffness = 250.0, root_damping = 32.0, root_weight = 0.85;
  double foot_stiffness = 500.0, foot_damping = 45.0, foot_weight = 5.0;
  double joint_stiffness = 300.0, joint_damping = 35.0, joint_weight = 0.15;
  double torque_weight = 0.02;  ///< Residual of a torque at its limit.
  double force_weight = 0.05;   ///< Residual of an edge force as large as the robot's weight.
  double friction = 0.7;        ///< Assumed friction coefficient, below that of the floor.
  double step_reach = 0.25;     ///< Largest shift of a swing foot by a capture step, metres.
  double offset_share = 0.9;    ///< Share of the offset from the reference that a step preserves.
  double follow_time = 0.1;     ///< Time constant with which the body follows its feet, seconds.
  double flight_reach = 0.15;   ///< Largest vertical shift of the feet in flight, metres.
  /// A foot that touches the floor in a flight of the reference has landed early if its reference
  /// touches down within early_time (seconds) and the centre of mass is more than early_height
  /// (metres) below its reference.
  double early_time = 0.15, early_height = 0.01;
};

/// Result of a control step.
struct ControlStep {
  std::vector<double> torques;  ///< Torque of each of PhysicsModel::joints, N m (N for slides);
                                ///< within the limits.
  /// Planned acceleration, by degree of freedom of the physics model.
  Eigen::VectorXd acceleration;
  std::vector<Eigen::Vector3d> forces;  ///< Planned contact forces at `points`, world, N.
  std::vector<int> points;  ///< Points near the floor, indices into PhysicsModel::points.
  bool converged = true;    ///< Whether the QP was solved; if not, the torques are 0.
};

/// Tracks a motion by a quadratic program in the joint torques and the contact forces, and keeps
/// the balance by capture steps (docs/simulation.md, "Controller").
class WholeBodyController {
 public:
  /// Keeps references to the model and the robot.
  WholeBodyController(const PhysicsModel& physics, const Robot& robot);
  ~WholeBodyController();

  /// Computes the torques of a control step. The result is valid until the next call.
  /// @param time_step  time since the last call, seconds.
  /// @param data       state of the physics model after mj_fwdPosition and mj_fwdVelocity.
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
  void add_root(mjData_* data);
  void add_feet(const ReferenceState& reference, mjData_* data);
  void add_joints(mjData_* data);
  void solve(const ReferenceState& reference);

  const PhysicsModel& physics_;
  const Robot& robot_;
  ControlGains gains_;  // Scaled to the size of the robot.
  double weight_, lever_;
  int joint_count_, input_count_ = 0;
  std::vector<Foot> feet_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();  // Of the body; horizontal, metres.
  std::vector<double> scales_;                        // Torque per unit of input, by joint.
  std::vector<double> loads_;            // One per point: largest edge force, share of the weight.
  std::vector<Eigen::Vector3d> places_;  // Positions of step_.points, world, metres.
  // By input, a torque or an edge force: generalised force, and the acceleration that it causes.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> inputs_, response_;
  Eigen::VectorXd free_;  // Accelerations without inputs.
  Eigen::VectorXd wanted_rates_, wanted_accelerations_, wanted_positions_;
  std::unique_ptr<Tasks> tasks_;
  BoxQp qp_;
  Eigen::VectorXd lower_, upper_, amounts_;
  ControlStep step_;
};

}  // namespace retarget
