// The engine of make_fast_solver(). docs/ik.md derives all formulas.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/root_pose.h"
#include "retarget/so3.h"
#include "robot/model/composite.h"
#include "solve/ik/active_set.h"
#include "solve/ik/ik_solver.h"
#include "solve/ik/task_batch.h"
#include "solve/ik/tree_system.h"

namespace retarget {
namespace {

// A body and the target that it follows in at least one pass.
struct Pair {
  int body;
  int target;

  bool operator==(const Pair&) const = default;
};

// The tasks of a pass.
struct Pass {
  std::vector<int> pairs;      // One per task.
  std::vector<int> on_links;   // The pairs whose body moves, without repetitions.
  TaskBatch::Weights weights;  // By pair.
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
  void add_pass(const IkPass& tasks);
  void take_targets(std::span<const Pose> targets);
  double measure_errors(int pass, std::span<const double> qpos);
  void build_system(int pass);
  void set_bounds(std::span<const double> qpos);
  void move(std::span<double> qpos) const;
  bool step(int pass, std::span<double> qpos);

  std::shared_ptr<const IkProblem> problem_;
  IkOptions options_;
  KinematicTree tree_;
  std::vector<Pair> pairs_;
  std::vector<Pass> passes_;
  std::vector<int> idle_joints_;  // Joints that carry no task.

  // A pass starts at the result of the previous pass and shares pairs with it. Therefore the errors
  // of all pairs are kept with the configuration and the targets to which they belong.
  TaskBatch errors_;  // By pair.
  std::vector<double> known_qpos_;
  std::vector<Pose> known_targets_;

  TreeState state_;
  std::vector<Composite> composites_;  // One per link.
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
    for (const FrameTask& task : pass) {
      const Pair pair{task.body, task.target};
      if (std::ranges::find(pairs_, pair) == pairs_.end()) pairs_.push_back(pair);
    }
  }
  std::vector<Pose> link_from_body;
  for (const Pair& pair : pairs_) {
    link_from_body.push_back(tree_.attachment(pair.body).link_from_body);
  }
  errors_ = TaskBatch(link_from_body);
  for (const IkPass& pass : problem_->passes) add_pass(pass);
  if (problem_->robot->fixed_base()) {
    lower_.head<KinematicTree::kBaseDofs>().setZero();
    upper_.head<KinematicTree::kBaseDofs>().setZero();
  }
  int target_count = 0;
  for (const Pair& pair : pairs_) target_count = std::max(target_count, pair.target + 1);
  known_targets_.resize(target_count);
  for (int j = 0; j < static_cast<int>(problem_->robot->joints().size()); ++j) {
    if (tree_.link_of_joint(j) == KinematicTree::kWorld) idle_joints_.push_back(j);
  }
}

void FastSolver::add_pass(const IkPass& tasks) {
  Pass& pass = passes_.emplace_back();
  pass.weights = errors_.zero_weights();
  for (const FrameTask& task : tasks) {
    const auto found = std::ranges::find(pairs_, Pair{task.body, task.target});
    const auto pair = static_cast<int>(found - pairs_.begin());
    const bool is_new = std::ranges::find(pass.pairs, pair) == pass.pairs.end();
    pass.pairs.push_back(pair);
    pass.weights.position[pair] += task.position_weight * task.position_weight;
    pass.weights.rotation[pair] += task.rotation_weight * task.rotation_weight;
    const bool moves = tree_.attachment(task.body).link != KinematicTree::kWorld;
    if (is_new && moves) pass.on_links.push_back(pair);
  }
}

PassResult FastSolver::solve_pass(int pass, std::span<const Pose> targets, std::span<double> qpos) {
  PassResult result;
  // No warm start, because the result must depend only on the arguments.
  active_set_.reset();
  take_targets(targets);
  result.errors[0] = measure_errors(pass, qpos);
  do {
    if (!step(pass, qpos)) {
      result.converged = false;
      break;
    }
    result.errors[++result.steps] = measure_errors(pass, qpos);
    if (!std::isfinite(result.errors[result.steps])) {
      result.converged = false;
      break;
    }
  } while (result.errors[result.steps - 1] - result.errors[result.steps] > options_.min_progress &&
           result.steps <= options_.max_extra_steps);
  return result;
}

void FastSolver::take_targets(std::span<const Pose> targets) {
  const auto same = [](const Pose& a, const Pose& b) {
    return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
  };
  const auto used = targets.first(known_targets_.size());
  if (std::ranges::equal(used, known_targets_, same)) return;
  std::ranges::copy(used, known_targets_.begin());
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    errors_.set_target(static_cast<int>(i), targets[pairs_[i].target]);
  }
  known_qpos_.front() = std::numeric_limits<double>::quiet_NaN();
}

// Computes the forward kinematics and one logarithm per pair, which the next step reuses.
// @return the norm of the stacked, unweighted errors of the pass.
double FastSolver::measure_errors(int pass, std::span<const double> qpos) {
  if (!std::ranges::equal(qpos, known_qpos_)) {
    state_.update(qpos);
    std::ranges::copy(qpos, known_qpos_.begin());
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const int link = tree_.attachment(pairs_[i].body).link;
      if (link != KinematicTree::kWorld) {
        errors_.set_link(static_cast<int>(i), state_.world_from_link[link]);
      }
    }
    errors_.measure(state_.origin());
  }
  double sum = 0.0;
  for (const int pair : passes_[pass].pairs) sum += errors_.squared_error(pair);
  return std::sqrt(sum);
}

// Assembles H and g from the forms |W (J V + e)|^2 / 2 of the tasks.
void FastSolver::build_system(int pass) {
  const Pass& tasks = passes_[pass];
  std::ranges::fill(composites_, Composite{});
  errors_.build_forms(tasks.weights);
  for (const int pair : tasks.on_links) {
    errors_.add_form(pair, composites_[tree_.attachment(pairs_[pair].body).link]);
  }
  damping_ = options_.damping;
  for (int pair = 0; pair < static_cast<int>(pairs_.size()); ++pair) {
    damping_ += options_.lm_damping * errors_.weighted_error(pair, tasks.weights);
  }
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
  const Eigen::Quaterniond turn = exp_so3(dq_.segment<3>(3));
  set_root_rotation(qpos, (state_.world_from_link[0].rotation * turn).normalized());
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
