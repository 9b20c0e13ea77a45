// The engine of make_fast_solver(). docs/ik.md derives all formulas.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/math/se3.h"
#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "robot/model/composite.h"
#include "solve/ik/active_set.h"
#include "solve/ik/frame_error.h"
#include "solve/ik/ik_solver.h"
#include "solve/ik/tree_system.h"

namespace retarget {
namespace {

// A body and the target that it follows in at least one pass.
struct Pair {
  int body;
  int target;
};

// A task of a pass.
struct Task {
  int pair;
  double position_weight_squared;
  double rotation_weight_squared;
};

// Bodies of all tasks, with repetitions.
std::vector<int> bodies_of(const IkProblem& problem) {
  std::vector<int> bodies;
  for (const IkPass& pass : problem.passes) {
    for (const FrameTask& task : pass) bodies.push_back(task.body);
  }
  return bodies;
}

class FastSolver final : public IkSolver {
 public:
  FastSolver(std::shared_ptr<const IkProblem> problem, const IkOptions& options);

  PassResult solve_pass(int pass, std::span<const Pose> targets, std::span<double> qpos) override;

 private:
  void forget_errors_of_other(std::span<const Pose> targets);
  double measure_errors(int pass, std::span<const Pose> targets, std::span<const double> qpos);
  void add_task(const Task& task);
  void build_system(int pass);
  void set_bounds(std::span<const double> qpos);
  void move(std::span<double> qpos) const;
  bool step(int pass, std::span<double> qpos);

  std::shared_ptr<const IkProblem> problem_;
  IkOptions options_;
  KinematicTree tree_;
  std::vector<Pair> pairs_;
  std::vector<std::vector<Task>> passes_;
  std::vector<int> idle_joints_;  // Joints that carry no task.

  // A pass starts at the result of the previous pass and shares pairs with it. Therefore errors_ is
  // a cache for this configuration and these targets.
  std::vector<double> known_qpos_;
  std::vector<Pose> known_targets_;
  std::vector<char> known_;  // By pair.

  TreeState state_;
  std::vector<FrameError> errors_;      // By pair.
  std::vector<Eigen::Vector3d> lever_;  // By pair: vector from the root's origin to the body, world
                                        // axes, metres.
  std::vector<Composite> composites_;   // By link.
  TreeSystem system_;
  ActiveSet active_set_;
  double damping_ = 0.0;
  Eigen::VectorXd lower_, upper_, dq_;
};

FastSolver::FastSolver(std::shared_ptr<const IkProblem> problem, const IkOptions& options)
    : problem_(std::move(problem)),
      options_(options),
      tree_(*problem_->robot, bodies_of(*problem_)),
      known_qpos_(problem_->robot->zero_configuration().size(),
                  std::numeric_limits<double>::quiet_NaN()),
      state_(tree_),
      composites_(tree_.links().size()),
      system_(tree_),
      active_set_(tree_.dof_count()),
      lower_(
          Eigen::VectorXd::Constant(tree_.dof_count(), -std::numeric_limits<double>::infinity())),
      upper_(-lower_),
      dq_(tree_.dof_count()) {
  for (const IkPass& pass : problem_->passes) {
    std::vector<Task>& tasks = passes_.emplace_back();
    for (const FrameTask& task : pass) {
      const auto same = [&](const Pair& pair) {
        return pair.body == task.body && pair.target == task.target;
      };
      const auto pair = static_cast<int>(std::ranges::find_if(pairs_, same) - pairs_.begin());
      if (pair == static_cast<int>(pairs_.size())) pairs_.push_back({task.body, task.target});
      tasks.push_back({pair, task.position_weight * task.position_weight,
                       task.rotation_weight * task.rotation_weight});
    }
  }
  if (problem_->robot->fixed_base()) {
    lower_.head<KinematicTree::kBaseDofs>().setZero();
    upper_.head<KinematicTree::kBaseDofs>().setZero();
  }
  errors_.resize(pairs_.size());
  lever_.resize(pairs_.size());
  known_.assign(pairs_.size(), 0);
  int target_count = 0;
  for (const Pair& pair : pairs_) target_count = std::max(target_count, pair.target + 1);
  known_targets_.resize(target_count);
  for (int j = 0; j < static_cast<int>(problem_->robot->joints().size()); ++j) {
    if (tree_.link_of_joint(j) == KinematicTree::kWorld) idle_joints_.push_back(j);
  }
}

PassResult FastSolver::solve_pass(int pass, std::span<const Pose> targets, std::span<double> qpos) {
  PassResult result;
  // No warm start, because the result must depend only on the arguments.
  active_set_.reset();
  forget_errors_of_other(targets);
  result.errors[0] = measure_errors(pass, targets, qpos);
  do {
    if (!step(pass, qpos)) {
      result.converged = false;
      break;
    }
    result.errors[++result.steps] = measure_errors(pass, targets, qpos);
    if (!std::isfinite(result.errors[result.steps])) {
      result.converged = false;
      break;
    }
  } while (result.errors[result.steps - 1] - result.errors[result.steps] > options_.min_progress &&
           result.steps <= options_.max_extra_steps);
  return result;
}

void FastSolver::forget_errors_of_other(std::span<const Pose> targets) {
  const auto same = [](const Pose& a, const Pose& b) {
    return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
  };
  const auto used = targets.first(known_targets_.size());
  if (std::ranges::equal(used, known_targets_, same)) return;
  std::ranges::copy(used, known_targets_.begin());
  std::ranges::fill(known_, 0);
}

// Computes the forward kinematics and one logarithm per task, which the next step reuses.
// @return the norm of the stacked, unweighted errors.
double FastSolver::measure_errors(int pass, std::span<const Pose> targets,
                                  std::span<const double> qpos) {
  if (!std::ranges::equal(qpos, known_qpos_)) {
    state_.update(qpos);
    std::ranges::copy(qpos, known_qpos_.begin());
    std::ranges::fill(known_, 0);
  }
  double sum = 0.0;
  for (const Task& task : passes_[pass]) {
    if (known_[task.pair] == 0) {
      const Pair& pair = pairs_[task.pair];
      const Pose world_from_body = state_.world_from_body(pair.body);
      lever_[task.pair] = world_from_body.translation - state_.origin();
      errors_[task.pair] = frame_error(world_from_body, targets[pair.target]);
      known_[task.pair] = 1;
    }
    sum += errors_[task.pair].squared_norm();
  }
  return std::sqrt(sum);
}

// Adds |W (J V + e)|^2 / 2 to the composite of the link that carries the body.
void FastSolver::add_task(const Task& task) {
  const FrameError& error = errors_[task.pair];
  const int link = tree_.attachment(pairs_[task.pair].body).link;
  const double wp = task.position_weight_squared;
  const double wr = task.rotation_weight_squared;
  damping_ += options_.lm_damping * (wp * error.linear.squaredNorm() + wr * error.angle_squared);
  if (link == KinematicTree::kWorld) return;
  Composite& composite = composites_[link];

  const ErrorJacobian jacobian(error);
  const Eigen::Matrix3d G = jacobian.square();
  composite.angular += wr * G;
  composite.torque -= wr * error.angular;
  if (wp == 0.0) return;

  // The rate of the linear part of the error is -A (v - K u), where K = skew(lever) + Q A, and v
  // and u are the linear velocity at the root's origin and the angular velocity of the link.
  const Eigen::Matrix3d K = skew(lever_[task.pair]) + jacobian.coupling();
  const Eigen::Matrix3d GK = G * K;
  const Eigen::Vector3d pull = wp * jacobian.transposed_times(error.linear);
  composite.linear += wp * G;
  composite.mixed -= wp * GK;
  composite.angular += wp * (K.transpose() * GK);
  composite.force -= pull;
  composite.torque += K.transpose() * pull;
}

void FastSolver::build_system(int pass) {
  std::ranges::fill(composites_, Composite{});
  damping_ = options_.damping;
  for (const Task& task : passes_[pass]) add_task(task);
  Eigen::VectorXd& linear = system_.linear();
  assemble(state_, composites_, system_.hessian(), std::span(linear.data(), linear.size()));
  system_.add_to_diagonal(damping_);
}

// Limits a step of a joint to the share `limit_gain` of its distance to a limit.
void FastSolver::set_bounds(std::span<const double> qpos) {
  for (std::size_t i = 1; i < tree_.links().size(); ++i) {
    const KinematicTree::Link& link = tree_.links()[i];
    const int dof = KinematicTree::dof_of(static_cast<int>(i));
    const double q = qpos[link.qpos_address];
    lower_[dof] = -options_.limit_gain * (q - problem_->lower[link.joint]);
    upper_[dof] = options_.limit_gain * (problem_->upper[link.joint] - q);
  }
}

// Adds the step to the joints and the root position, and rotates the root about its own axes.
void FastSolver::move(std::span<double> qpos) const {
  for (int i = 0; i < 3; ++i) qpos[i] += dq_[i];
  const Eigen::Quaterniond turned =
      (state_.world_from_link[0].rotation * exp_so3(dq_.segment<3>(3))).normalized();
  qpos[3] = turned.w();
  for (int i = 0; i < 3; ++i) qpos[4 + i] = turned.vec()[i];
  for (std::size_t i = 1; i < tree_.links().size(); ++i) {
    qpos[tree_.links()[i].qpos_address] += dq_[KinematicTree::dof_of(static_cast<int>(i))];
  }
  // No task moves these joints, but a joint that starts outside its limits must return inside.
  for (const int j : idle_joints_) {
    double& q = qpos[problem_->robot->joints()[j].qpos_address];
    q += std::clamp(0.0, -options_.limit_gain * (q - problem_->lower[j]),
                    options_.limit_gain * (problem_->upper[j] - q));
  }
}

bool FastSolver::step(int pass, std::span<double> qpos) {
  build_system(pass);
  set_bounds(qpos);
  if (!active_set_.solve(system_, lower_, upper_, dq_).converged) return false;
  move(qpos);
  return true;
}

}  // namespace

std::unique_ptr<IkSolver> make_fast_solver(std::shared_ptr<const IkProblem> problem,
                                           const IkOptions& options) {
  return std::make_unique<FastSolver>(std::move(problem), options);
}

}  // namespace retarget
