// The engine that uses the structure of the problem; see docs/ik.md for every formula.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "ik/active_set.h"
#include "ik/frame_error.h"
#include "ik/ik_solver.h"
#include "ik/moving_tree.h"
#include "ik/tree_system.h"
#include "math/se3.h"
#include "math/so3.h"

namespace retarget {
namespace {

// quadratic form 1/2 V'AV - b'V in the motion V = [v; w] of everything below a node, v being the
// velocity of the root's origin if it moved along, in world axes
struct Composite {
  Eigen::Matrix3d linear, mixed, angular;  // [[linear, mixed], [mixed', angular]]
  Eigen::Vector3d force, torque;           // gradient: minus b

  void set_zero() {
    linear.setZero();
    mixed.setZero();
    angular.setZero();
    force.setZero();
    torque.setZero();
  }
  void operator+=(const Composite& other) {
    linear += other.linear;
    mixed += other.mixed;
    angular += other.angular;
    force += other.force;
    torque += other.torque;
  }
};

// a body and a target that at least one pass brings together
struct Pair {
  int attachment;  // index into the tree's attachments
  int target;
};

// a task of a pass
struct Task {
  int pair;
  double position_weight_squared;
  double rotation_weight_squared;
};

// bodies of all tasks, each once
std::vector<int> bodies_of(const IkProblem& problem) {
  std::vector<int> bodies;
  for (const IkPass& pass : problem.passes) {
    for (const FrameTask& task : pass) {
      if (std::ranges::find(bodies, task.body) == bodies.end()) bodies.push_back(task.body);
    }
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
  void find_motion(int node);
  void fill_base_rows();
  void fill_node_row(int node);
  void set_bounds(std::span<const double> qpos);
  void move(std::span<double> qpos) const;
  bool step(int pass, std::span<double> qpos);

  std::shared_ptr<const IkProblem> problem_;
  IkOptions options_;
  MovingTree tree_;
  std::vector<Pair> pairs_;
  std::vector<std::vector<Task>> passes_;
  std::vector<int> idle_joints_;  // joints that carry no task: nothing pulls them

  // a pass begins where another ended, and its tasks share pairs with the other's: what is known
  // of a configuration and its targets is not computed again
  std::vector<double> known_qpos_;
  std::vector<Pose> known_targets_;
  std::vector<char> known_;  // by pair

  TreeState state_;
  std::vector<FrameError> errors_;      // by pair
  std::vector<Eigen::Vector3d> lever_;  // by pair, from the root's origin to the body
  // by node: a joint's motion, the velocity of the root's origin if it moved along and the angular
  std::vector<Eigen::Vector3d> motion_linear_, motion_angular_;
  Composite base_;
  std::vector<Composite> composites_;  // by node
  Eigen::Matrix3d world_from_base_;
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
      motion_linear_(tree_.nodes().size()),
      motion_angular_(tree_.nodes().size()),
      composites_(tree_.nodes().size()),
      system_(tree_),
      active_set_(tree_.dof_count()),
      lower_(
          Eigen::VectorXd::Constant(tree_.dof_count(), -std::numeric_limits<double>::infinity())),
      upper_(-lower_),
      dq_(tree_.dof_count()) {
  const std::vector<int> bodies = bodies_of(*problem_);
  for (const IkPass& pass : problem_->passes) {
    std::vector<Task>& tasks = passes_.emplace_back();
    for (const FrameTask& task : pass) {
      const auto attachment =
          static_cast<int>(std::ranges::find(bodies, task.body) - bodies.begin());
      const auto same = [&](const Pair& pair) {
        return pair.attachment == attachment && pair.target == task.target;
      };
      const auto pair = static_cast<int>(std::ranges::find_if(pairs_, same) - pairs_.begin());
      if (pair == static_cast<int>(pairs_.size())) pairs_.push_back({attachment, task.target});
      tasks.push_back({pair, task.position_weight * task.position_weight,
                       task.rotation_weight * task.rotation_weight});
    }
  }
  errors_.resize(pairs_.size());
  lever_.resize(pairs_.size());
  known_.assign(pairs_.size(), 0);
  int target_count = 0;
  for (const Pair& pair : pairs_) target_count = std::max(target_count, pair.target + 1);
  known_targets_.resize(target_count);
  std::vector<char> moves(problem_->robot->joints().size(), 0);
  for (const MovingTree::Node& node : tree_.nodes()) moves[node.joint] = 1;
  for (std::size_t j = 0; j < moves.size(); ++j) {
    if (moves[j] == 0) idle_joints_.push_back(static_cast<int>(j));
  }
}

PassResult FastSolver::solve_pass(int pass, std::span<const Pose> targets, std::span<double> qpos) {
  PassResult result;
  // what comes out depends on what goes in alone, not on the frame before
  active_set_.reset();
  forget_errors_of_other(targets);
  result.errors[0] = measure_errors(pass, targets, qpos);
  do {
    if (!step(pass, qpos)) {
      result.converged = false;
      break;
    }
    result.errors[++result.steps] = measure_errors(pass, targets, qpos);
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

// kinematics and one logarithm per task, which the next step uses again
double FastSolver::measure_errors(int pass, std::span<const Pose> targets,
                                  std::span<const double> qpos) {
  if (!std::ranges::equal(qpos, known_qpos_)) {
    state_.update(tree_, qpos);
    std::ranges::copy(qpos, known_qpos_.begin());
    std::ranges::fill(known_, 0);
  }
  double sum = 0.0;
  for (const Task& task : passes_[pass]) {
    if (known_[task.pair] == 0) {
      const Pair& pair = pairs_[task.pair];
      const Pose world_from_body = state_.world_from_body(tree_.attachments()[pair.attachment]);
      lever_[task.pair] = world_from_body.translation - state_.world_from_base.translation;
      errors_[task.pair] = frame_error(world_from_body, targets[pair.target]);
      known_[task.pair] = 1;
    }
    sum += errors_[task.pair].squared_norm();
  }
  return std::sqrt(sum);
}

// adds |W (J V + e)|^2 / 2 to the composite of the node that carries the body
void FastSolver::add_task(const Task& task) {
  const FrameError& error = errors_[task.pair];
  const int node = tree_.attachments()[pairs_[task.pair].attachment].node;
  const double wp = task.position_weight_squared;
  const double wr = task.rotation_weight_squared;
  damping_ += options_.lm_damping * (wp * error.linear.squaredNorm() + wr * error.angle_squared);
  if (node == MovingTree::kWorld) return;
  Composite& composite = node == MovingTree::kBase ? base_ : composites_[node];

  const ErrorJacobian jacobian(error);
  const Eigen::Matrix3d G = jacobian.square();
  composite.angular += wr * G;
  composite.torque -= wr * error.angular;
  if (wp == 0.0) return;

  // the error's linear part changes with -A (v - K u), K = skew(lever) + Q A
  const Eigen::Matrix3d K = skew(lever_[task.pair]) + jacobian.coupling();
  const Eigen::Matrix3d GK = G * K;
  const Eigen::Vector3d pull = wp * jacobian.transposed_times(error.linear);
  composite.linear += wp * G;
  composite.mixed -= wp * GK;
  composite.angular += wp * (K.transpose() * GK);
  composite.force -= pull;
  composite.torque += K.transpose() * pull;
}

// composites up the tree, then H and g with the joints' motions
void FastSolver::build_system(int pass) {
  base_.set_zero();
  for (Composite& composite : composites_) composite.set_zero();
  damping_ = options_.damping;
  for (const Task& task : passes_[pass]) add_task(task);
  for (int i = 0; i < static_cast<int>(composites_.size()); ++i) find_motion(i);
  for (int i = static_cast<int>(composites_.size()) - 1; i >= 0; --i) {
    fill_node_row(i);
    const int parent = tree_.nodes()[i].parent;
    (parent == MovingTree::kBase ? base_ : composites_[parent]) += composites_[i];
  }
  fill_base_rows();
}

void FastSolver::fill_base_rows() {
  const Eigen::Matrix3d turned_mixed = world_from_base_.transpose() * base_.mixed.transpose();
  const Eigen::Matrix3d turned_angular =
      world_from_base_.transpose() * base_.angular * world_from_base_;
  for (int i = 0; i < 3; ++i) {
    double* const linear = system_.row(i);
    for (int j = 0; j <= i; ++j) linear[j] = base_.linear(i, j);
    linear[i] += damping_;
    double* const angular = system_.row(3 + i);
    for (int j = 0; j < 3; ++j) angular[j] = turned_mixed(i, j);
    for (int j = 0; j <= i; ++j) angular[3 + j] = turned_angular(i, j);
    angular[3 + i] += damping_;
  }
  system_.linear().head<3>() = base_.force;
  system_.linear().segment<3>(3) = world_from_base_.transpose() * base_.torque;
}

void FastSolver::find_motion(int index) {
  const Eigen::Vector3d& axis = state_.axis[index];
  if (tree_.nodes()[index].slides) {
    motion_linear_[index] = axis;
    motion_angular_[index].setZero();
    return;
  }
  const Eigen::Vector3d& origin = state_.world_from_base.translation;
  motion_linear_[index] = axis.cross(origin - state_.world_from_node[index].translation);
  motion_angular_[index] = axis;
}

// with the joint's motion S = [v; w] the force F = A S, and S_j' F for all joints that carry it
void FastSolver::fill_node_row(int index) {
  const MovingTree::Node& node = tree_.nodes()[index];
  const Composite& composite = composites_[index];
  const Eigen::Vector3d& v = motion_linear_[index];
  const Eigen::Vector3d& w = motion_angular_[index];
  const Eigen::Vector3d force = composite.linear * v + composite.mixed * w;
  const Eigen::Vector3d torque = composite.mixed.transpose() * v + composite.angular * w;

  double* const row = system_.row(MovingTree::kBaseDofs + index);
  const Eigen::Vector3d base_torque = world_from_base_.transpose() * torque;
  for (int i = 0; i < 3; ++i) {
    row[i] = force[i];
    row[3 + i] = base_torque[i];
  }
  for (int j = index, at = MovingTree::kBaseDofs + node.depth; j >= 0;
       j = tree_.nodes()[j].parent, --at) {
    row[at] = motion_linear_[j].dot(force) + motion_angular_[j].dot(torque);
  }
  row[MovingTree::kBaseDofs + node.depth] += damping_;
  system_.linear()[MovingTree::kBaseDofs + index] =
      v.dot(composite.force) + w.dot(composite.torque);
}

// a step may take a joint the given share of its way to a limit
void FastSolver::set_bounds(std::span<const double> qpos) {
  for (std::size_t i = 0; i < tree_.nodes().size(); ++i) {
    const MovingTree::Node& node = tree_.nodes()[i];
    const double q = qpos[node.qpos_address];
    lower_[MovingTree::kBaseDofs + i] = -options_.limit_gain * (q - problem_->lower[node.joint]);
    upper_[MovingTree::kBaseDofs + i] = options_.limit_gain * (problem_->upper[node.joint] - q);
  }
}

// joints add up; the root moves in the world and turns in its own axes
void FastSolver::move(std::span<double> qpos) const {
  for (int i = 0; i < 3; ++i) qpos[i] += dq_[i];
  const Eigen::Quaterniond turned =
      (state_.world_from_base.rotation * exp_so3(dq_.segment<3>(3))).normalized();
  qpos[3] = turned.w();
  for (int i = 0; i < 3; ++i) qpos[4 + i] = turned.vec()[i];
  for (std::size_t i = 0; i < tree_.nodes().size(); ++i) {
    qpos[tree_.nodes()[i].qpos_address] += dq_[MovingTree::kBaseDofs + i];
  }
  // nothing pulls these, but one that starts outside its limits comes back like the others
  for (const int j : idle_joints_) {
    double& q = qpos[problem_->robot->joints()[j].qpos_address];
    q += std::clamp(0.0, -options_.limit_gain * (q - problem_->lower[j]),
                    options_.limit_gain * (problem_->upper[j] - q));
  }
}

bool FastSolver::step(int pass, std::span<double> qpos) {
  world_from_base_ = state_.world_from_base.rotation.toRotationMatrix();
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
