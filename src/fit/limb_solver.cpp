#include "fit/limb_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "fit/shorthand.h"
#include "retarget/human.h"

namespace retarget {
namespace {

using Eigen::Vector3d;

bool is_of_arm(LimbBone part) {
  return part == LimbBone::kShoulder || part == LimbBone::kArm || part == LimbBone::kForeArm ||
         part == LimbBone::kHand;
}

// the chain from the last body that follows one of its bones up to what carries other tasks as well
FitLimb find_limb(const FitModel& model, Side side, bool arm) {
  FitLimb limb;
  limb.name = std::string(side == Side::kLeft ? "left " : "right ") + (arm ? "arm" : "leg");
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
  return limb;
}

}  // namespace

std::vector<FitLimb> find_limbs(const FitModel& model) {
  std::vector<FitLimb> limbs;
  for (const Side side : kSides) {
    for (const bool arm : {true, false}) {
      FitLimb limb = find_limb(model, side, arm);
      if (limb.links.empty() || at(kMaxLimbJoints) < limb.links.size()) continue;
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
    if (task.rotation_weight > 0.0) {
      cost += square(task.rotation_weight) * rotation_error(world, target).squaredNorm();
    }
  }
  return cost;
}

void LimbSolver::assemble(const TreeState& pose, const FrameGoals& goals, Matrix& hessian,
                          Vector& gradient) const {
  hessian.setZero(count(), count());
  gradient.setZero(count());
  std::array<Vector3d, kMaxLimbJoints> moves, turns;
  for (const std::size_t k : limb_.tasks) {
    const FitTask& task = model_.tasks[k];
    const Pose& world = pose.world_from_link[at(task.link)];
    const Vector3d point = world * task.position;
    const Vector3d weights = position_weights(task, goals);
    const double turn_weight = square(task.rotation_weight);
    const Vector3d force = weights.cwiseProduct(point - goals.targets[k].position);
    Vector3d torque = Vector3d::Zero();
    if (turn_weight > 0.0) torque = turn_weight * rotation_error(world, goals.targets[k]);
    for (int i = 0; i < count() && model_.tree.carries(limb_.links[at(i)], task.link); ++i) {
      const int dof = KinematicTree::dof_of(limb_.links[at(i)]);
      moves[at(i)] = pose.velocity_at(dof, point);
      turns[at(i)] = pose.angular[at(dof)];
      gradient[i] += moves[at(i)].dot(force) + turns[at(i)].dot(torque);
      for (int j = 0; j <= i; ++j) {
        hessian(i, j) += moves[at(i)].dot(weights.cwiseProduct(moves[at(j)])) +
                         turn_weight * turns[at(i)].dot(turns[at(j)]);
      }
    }
  }
}

// joints at a limit that want to go beyond it stay there
void LimbSolver::hold_limits(const Vector& joints, const LimbRange& range, Matrix& hessian,
                             Vector& gradient) const {
  for (int i = 0; i < count(); ++i) {
    const bool below = joints[i] <= range.lower[at(i)] && gradient[i] > 0.0;
    const bool above = joints[i] >= range.upper[at(i)] && gradient[i] < 0.0;
    if (!below && !above) continue;
    hessian.row(i).head(i).setZero();
    hessian.col(i).tail(count() - i).setZero();
    hessian(i, i) = 1.0;
    gradient[i] = 0.0;
  }
}

void LimbSolver::place(const Vector& joints, const LimbRange& range, TreeState& pose,
                       std::span<double> qpos) const {
  for (int i = 0; i < count(); ++i) {
    joint_value(model_, limb_.links[at(i)], qpos) =
        std::clamp(joints[i], range.lower[at(i)], range.upper[at(i)]);
  }
  pose.update_subtree(limb_.link, qpos);
}

double LimbSolver::solve(const FrameGoals& goals, const LimbRange& range, TreeState& pose,
                         std::span<double> qpos) const {
  constexpr int kMaxSteps = 25;
  // on the diagonal, and times the diagonal
  constexpr double kConstant = 1.0, kFirstFactor = 0.01, kMinFactor = 1e-3;
  constexpr double kMaxFactor = 1e4, kGrowth = 4.0, kDecay = 0.3;
  constexpr double kLongestTurn = 0.6;                     // rad, of one step
  constexpr double kSettledShare = 1e-3, kSettled = 1e-3;  // of the cost
  Matrix hessian, damped;
  Vector gradient, held, before(count());
  double now = cost(pose, goals), damping = kFirstFactor;
  assemble(pose, goals, hessian, gradient);
  for (int step = 0; step < kMaxSteps && damping < kMaxFactor; ++step) {
    for (int i = 0; i < count(); ++i) before[i] = joint_value(model_, limb_.links[at(i)], qpos);
    damped = hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += kConstant;
    held = gradient;
    hold_limits(before, range, damped, held);
    const Vector way = Eigen::LLT<Matrix, Eigen::Lower>(damped).solve(held);
    const double shortened = kLongestTurn / std::max(kLongestTurn, way.cwiseAbs().maxCoeff());
    place(before - shortened * way, range, pose, qpos);
    const double then = cost(pose, goals);
    if (!(then < now)) {
      place(before, range, pose, qpos);
      damping = std::max(damping, kMinFactor) * kGrowth;
      continue;
    }
    const bool settled = now - then < kSettledShare * now + kSettled && shortened == 1.0;
    now = then;
    if (settled) break;
    damping *= kDecay;
    assemble(pose, goals, hessian, gradient);
  }
  return now;
}

}  // namespace retarget
