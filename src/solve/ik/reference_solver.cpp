#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/math/se3.h"
#include "retarget/pose.h"
#include "robot/model/model_values.h"
#include "solve/ik/box_qp.h"
#include "solve/ik/ik_solver.h"
#include "solve/ik/published_jacobian.h"

namespace retarget {
namespace {

using RowMajorJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

class ReferenceSolver final : public IkSolver {
 public:
  ReferenceSolver(std::shared_ptr<const IkProblem> problem, const IkOptions& options,
                  std::function<void(const QpRecord&)> observe);

  PassResult solve_pass(int pass, std::span<const Pose> targets, std::span<double> qpos) override;

 private:
  void update_kinematics();
  double measure_errors(const IkPass& tasks, std::span<const Pose> targets);
  void add_task(const FrameTask& task, const Vector6d& error);
  void set_bounds();
  bool step(const IkPass& tasks);

  std::shared_ptr<const IkProblem> problem_;
  IkOptions options_;
  std::function<void(const QpRecord&)> observe_;
  const mjModel* model_;
  MujocoData data_;
  BoxQp qp_;
  std::vector<Vector6d> errors_;  // By task of the current pass, at the current configuration.
  RowMajorJacobian world_linear_, world_angular_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> body_jacobian_, weighted_jacobian_;
  Eigen::MatrixXd H_;
  Eigen::VectorXd c_, lower_, upper_, dq_;
};

ReferenceSolver::ReferenceSolver(std::shared_ptr<const IkProblem> problem, const IkOptions& options,
                                 std::function<void(const QpRecord&)> observe)
    : problem_(std::move(problem)),
      options_(options),
      observe_(std::move(observe)),
      model_(problem_->robot->model()),
      data_(mj_makeData(model_)),
      qp_(model_->nv),
      world_linear_(3, model_->nv),
      world_angular_(3, model_->nv),
      body_jacobian_(6, model_->nv),
      weighted_jacobian_(6, model_->nv),
      H_(model_->nv, model_->nv),
      c_(model_->nv),
      lower_(model_->nv),
      upper_(model_->nv),
      dq_(model_->nv) {
  std::size_t max_tasks = 0;
  for (const IkPass& pass : problem_->passes) max_tasks = std::max(max_tasks, pass.size());
  errors_.resize(max_tasks);
}

PassResult ReferenceSolver::solve_pass(int pass, std::span<const Pose> targets,
                                       std::span<double> qpos) {
  const IkPass& tasks = problem_->passes[pass];
  mju_copy(data_->qpos, qpos.data(), model_->nq);
  update_kinematics();

  PassResult result;
  result.errors[0] = measure_errors(tasks, targets);
  do {
    if (!step(tasks)) {
      result.converged = false;
      break;
    }
    update_kinematics();
    result.errors[++result.steps] = measure_errors(tasks, targets);
    if (!std::isfinite(result.errors[result.steps])) {
      result.converged = false;
      break;
    }
  } while (result.errors[result.steps - 1] - result.errors[result.steps] > options_.min_progress &&
           result.steps <= options_.max_extra_steps);
  mju_copy(qpos.data(), data_->qpos, model_->nq);
  return result;
}

void ReferenceSolver::update_kinematics() {
  mj_kinematics(model_, data_.get());
  mj_comPos(model_, data_.get());
}

// Computes the error twists of all tasks in body axes.
// @return the norm of the stacked, unweighted twists.
double ReferenceSolver::measure_errors(const IkPass& tasks, std::span<const Pose> targets) {
  double sum = 0.0;
  for (std::size_t k = 0; k < tasks.size(); ++k) {
    const int body = tasks[k].body;
    // The conversion from the rotation matrix gives the last digits of the published method.
    double wxyz[4];
    mju_mat2Quat(wxyz, data_->xmat + 9 * body);
    const Pose world_from_body{Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]),
                               Eigen::Map<const Eigen::Vector3d>(data_->xpos + 3 * body)};
    errors_[k] = log_se3(world_from_body.inverse() * targets[tasks[k].target]);
    sum += errors_[k].squaredNorm();
  }
  return std::sqrt(sum);
}

// Adds 1/2 |W (J dq + e)|^2 and the Levenberg-Marquardt term of a task to the objective.
void ReferenceSolver::add_task(const FrameTask& task, const Vector6d& error) {
  mj_jacBody(model_, data_.get(), world_linear_.data(), world_angular_.data(), task.body);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> world_from_body(
      data_->xmat + 9 * task.body);
  body_jacobian_.topRows<3>().noalias() = world_from_body.transpose() * world_linear_;
  body_jacobian_.bottomRows<3>().noalias() = world_from_body.transpose() * world_angular_;

  // d log(body_from_target) / dq = -(inverse left Jacobian at the error) * body Jacobian.
  Vector6d weights;
  weights << Eigen::Vector3d::Constant(task.position_weight),
      Eigen::Vector3d::Constant(task.rotation_weight);
  const Matrix6d weighted = -(weights.asDiagonal() * published_jacobian_inverse(error));
  weighted_jacobian_.noalias() = weighted * body_jacobian_;
  const Vector6d weighted_error = weights.cwiseProduct(error);

  H_.selfadjointView<Eigen::Lower>().rankUpdate(weighted_jacobian_.transpose());
  H_.diagonal().array() += options_.lm_damping * weighted_error.squaredNorm();
  c_.noalias() += weighted_jacobian_.transpose() * weighted_error;
}

// Limits a step of a joint to the share `limit_gain` of its distance to a limit.
void ReferenceSolver::set_bounds() {
  lower_.setConstant(-std::numeric_limits<double>::infinity());
  upper_.setConstant(std::numeric_limits<double>::infinity());
  if (problem_->robot->fixed_base()) {
    constexpr int kBaseDofs = 6;
    lower_.head<kBaseDofs>().setZero();
    upper_.head<kBaseDofs>().setZero();
  }
  const auto& joints = problem_->robot->joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double q = data_->qpos[joints[j].qpos_address];
    lower_[joints[j].dof_address] = -options_.limit_gain * (q - problem_->lower[j]);
    upper_[joints[j].dof_address] = options_.limit_gain * (problem_->upper[j] - q);
  }
}

bool ReferenceSolver::step(const IkPass& tasks) {
  H_.setZero();
  H_.diagonal().setConstant(options_.damping);
  c_.setZero();
  for (std::size_t k = 0; k < tasks.size(); ++k) add_task(tasks[k], errors_[k]);
  set_bounds();
  if (!qp_.solve(H_, c_, lower_, upper_, dq_).converged) return false;
  if (observe_) observe_({H_, c_, lower_, upper_, dq_});
  mj_integratePos(model_, data_->qpos, dq_.data(), 1.0);
  return true;
}

}  // namespace

std::unique_ptr<IkSolver> make_reference_solver(std::shared_ptr<const IkProblem> problem,
                                                const IkOptions& options,
                                                std::function<void(const QpRecord&)> observe) {
  return std::make_unique<ReferenceSolver>(std::move(problem), options, std::move(observe));
}

}  // namespace retarget
