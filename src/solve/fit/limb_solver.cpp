#include "solve/fit/limb_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/least_squares.h"
#include "retarget/human.h"
#include "solve/fit/shorthand.h"
#include "solve/fit/task_terms.h"

namespace retarget {
namespace {

using Eigen::Vector3d;
using LimbVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxLimbJoints, 1>;
using Matrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxLimbJoints, kMaxLimbJoints>;

bool is_of_arm(LimbBone part) {
  return part == LimbBone::kShoulder || part == LimbBone::kArm || part == LimbBone::kForeArm ||
         part == LimbBone::kHand;
}

// Collects the chain from the outermost body with a task of this limb inwards, up to the first link
// that also carries other tasks.
FitLimb find_limb(const FitModel& model, Side side, bool arm) {
  FitLimb limb;
  limb.name = std::string(side == Side::kLeft ? "left " : "right ") + (arm ? "arm" : "leg");
  limb.is_arm = arm;
  const auto is_own = [&](const FitTask& task) {
    const auto part = limb_bone(task.bone);
    return part && side_of(task.bone) == side && is_of_arm(*part) == arm;
  };
  int last = 0;
  for (const FitTask& task : model.tasks) {
    if (is_own(task)) last = std::max(last, task.link);
  }
  for (int link = last; link > 0; link = model.tree.links()[at(link)].parent) {
    const bool others = std::ranges::any_of(model.tasks, [&](const FitTask& task) {
      return !is_own(task) && model.tree.carries(link, task.link);
    });
    if (others) break;
    limb.link = link;
    const std::size_t dof = at(KinematicTree::dof_of(link));
    if (model.lower[dof] < model.upper[dof]) limb.links.push_back(link);
  }
  std::ranges::reverse(limb.links);
  for (std::size_t k = 0; limb.link > 0 && k < model.tasks.size(); ++k) {
    if (model.tree.carries(limb.link, model.tasks[k].link)) limb.tasks.push_back(k);
  }
  limb.reversed.resize(limb.links.size());
  return limb;
}

// Sets FitLimb::reversed of the right limb. The mirror plane is half-way between the first joints of
// both limbs.
void compare_with_left(const FitModel& model, const FitLimb& left, FitLimb& right) {
  constexpr double kOpposite = -0.9;  // Cosine of the angle between axes.
  if (left.links.size() != right.links.size()) return;
  std::vector<double> zero(at(model.configuration_size));
  zero[3] = 1.0;
  const TreeState pose(model.tree, zero);
  const auto origin = [&](const FitLimb& limb) -> const Vector3d& {
    return pose.world_from_link[at(limb.link)].translation;
  };
  const Vector3d normal = (origin(left) - origin(right)).stableNormalized();
  for (std::size_t i = 0; i < right.links.size(); ++i) {
    const int left_link = left.links[i], right_link = right.links[i];
    const bool slides = model.tree.links()[at(left_link)].slides;
    if (slides != model.tree.links()[at(right_link)].slides) continue;
    const auto axis = [&](int link) -> const Vector3d& {
      return (slides ? pose.linear : pose.angular)[at(KinematicTree::dof_of(link))];
    };
    const Vector3d translated = axis(left_link) - 2.0 * normal.dot(axis(left_link)) * normal;
    // A mirrored rotation has the mirrored axis and the opposite angle.
    const Vector3d mirrored = slides ? translated : Vector3d(-translated);
    right.reversed[i] = axis(right_link).dot(mirrored) < kOpposite;
  }
}

}  // namespace

std::vector<FitLimb> find_limbs(const FitModel& model) {
  std::vector<FitLimb> limbs;
  for (const Side side : kSides) {
    for (const bool arm : {true, false}) {
      FitLimb limb = find_limb(model, side, arm);
      if (limb.links.empty() || at(kMaxLimbJoints) < limb.links.size()) continue;
      const auto left = std::ranges::find(limbs, arm, &FitLimb::is_arm);
      if (side == Side::kRight && left != limbs.end()) compare_with_left(model, *left, limb);
      limbs.push_back(std::move(limb));
    }
  }
  return limbs;
}

LimbSolver::LimbSolver(const FitModel& model, const FitLimb& limb) : model_(model), limb_(limb) {
  for (std::size_t i = 0; i < limb.links.size(); ++i) {
    const std::size_t dof = at(KinematicTree::dof_of(limb.links[i]));
    limits_.lower[i] = model.lower[dof];
    limits_.upper[i] = model.upper[dof];
  }
}

double LimbSolver::cost(const TreeState& pose, const FrameGoals& goals) const {
  double cost = 0.0;
  for (const std::size_t k : limb_.tasks) {
    const FitTask& task = model_.tasks[k];
    const TaskTarget& target = goals.targets[k];
    const Pose& world = pose.world_from_link[at(task.link)];
    const Vector3d error = world * task.position - target.position;
    cost += position_weights(task, goals).dot(error.cwiseAbs2());
    cost += rotation_term(task, goals, world, target).cost;
  }
  return cost;
}

namespace {

// The least-squares problem of a limb in one frame, for damped_least_squares(). `pose` and `qpos`
// hold the current iterate.
class LimbDescent {
 public:
  LimbDescent(const LimbSolver& solver, const FitModel& model, const FitLimb& limb,
              const FrameGoals& goals, const LimbRange& range, TreeState& pose,
              std::span<double> qpos)
      : solver_(solver),
        model_(model),
        limb_(limb),
        goals_(goals),
        range_(range),
        pose_(pose),
        qpos_(qpos),
        joints_(count()) {}

  [[nodiscard]] double cost() const { return solver_.cost(pose_, goals_); }
  void linearise();
  std::optional<double> solve(double damping);
  double try_step(double length) {
    place(joints_ + length * step_);
    return cost();
  }
  void accept() {}
  void reject() { place(joints_); }

 private:
  [[nodiscard]] int count() const { return static_cast<int>(limb_.links.size()); }
  void hold_limits();
  void place(const LimbVector& joints);

  const LimbSolver& solver_;
  const FitModel& model_;
  const FitLimb& limb_;
  const FrameGoals& goals_;
  const LimbRange& range_;
  TreeState& pose_;
  std::span<double> qpos_;
  LimbVector joints_, gradient_, held_, step_;
  Matrix hessian_, damped_;
};

void LimbDescent::linearise() {
  hessian_.setZero(count(), count());
  gradient_.setZero(count());
  std::array<Vector3d, kMaxLimbJoints> moves, rates;
  for (const std::size_t k : limb_.tasks) {
    const FitTask& task = model_.tasks[k];
    const Pose& world = pose_.world_from_link[at(task.link)];
    const Vector3d point = world * task.position;
    const Vector3d weights = position_weights(task, goals_);
    const RotationTerm rotation = rotation_term(task, goals_, world, goals_.targets[k]);
    const Vector3d force = weights.cwiseProduct(point - goals_.targets[k].position);
    for (int i = 0; i < count() && model_.tree.carries(limb_.links[at(i)], task.link); ++i) {
      const int dof = KinematicTree::dof_of(limb_.links[at(i)]);
      moves[at(i)] = pose_.velocity_at(dof, point);
      rates[at(i)] = pose_.angular[at(dof)];
      gradient_[i] += moves[at(i)].dot(force) + rates[at(i)].dot(rotation.gradient);
      for (int j = 0; j <= i; ++j) {
        hessian_(i, j) += moves[at(i)].dot(weights.cwiseProduct(moves[at(j)])) +
                          rates[at(i)].dot(rotation.hessian * rates[at(j)]);
      }
    }
  }
}

std::optional<double> LimbDescent::solve(double damping) {
  constexpr double kConstant = 1.0;  // Damping in addition to the damping relative to the diagonal.
  for (int i = 0; i < count(); ++i) joints_[i] = joint_value(model_, limb_.links[at(i)], qpos_);
  damped_ = hessian_;
  damped_.diagonal() *= 1.0 + damping;
  damped_.diagonal().array() += kConstant;
  held_ = gradient_;
  hold_limits();
  step_ = -Eigen::LLT<Matrix, Eigen::Lower>(damped_).solve(held_);
  return step_.allFinite() ? step_.cwiseAbs().maxCoeff() : NAN;
}

// Fixes joints that are at a limit and that the gradient would move beyond it: one iteration of an
// active-set method.
void LimbDescent::hold_limits() {
  for (int i = 0; i < count(); ++i) {
    const bool below = joints_[i] <= range_.lower[at(i)] && held_[i] > 0.0;
    const bool above = joints_[i] >= range_.upper[at(i)] && held_[i] < 0.0;
    if (!below && !above) continue;
    damped_.row(i).head(i).setZero();
    damped_.col(i).tail(count() - i).setZero();
    damped_(i, i) = 1.0;
    held_[i] = 0.0;
  }
}

void LimbDescent::place(const LimbVector& joints) {
  for (int i = 0; i < count(); ++i) {
    joint_value(model_, limb_.links[at(i)], qpos_) =
        std::clamp(joints[i], range_.lower[at(i)], range_.upper[at(i)]);
  }
  pose_.update_subtree(limb_.link, qpos_);
}

}  // namespace

double LimbSolver::solve(const FrameGoals& goals, const LimbRange& range, TreeState& pose,
                         std::span<double> qpos) const {
  constexpr LeastSquaresPolicy kPolicy{.max_steps = 25,
                                       .initial_damping = 0.01,
                                       .shrink = 0.3,
                                       .growth = 4.0,
                                       .min_increased = 4e-3,
                                       .max_damping = 1e4,
                                       .max_step = 0.6,  // Radians.
                                       .relative_change = 1e-3,
                                       .absolute_change = 1e-3};
  LimbDescent problem(*this, model_, limb_, goals, range, pose, qpos);
  return damped_least_squares(problem, kPolicy).cost;
}

}  // namespace retarget
