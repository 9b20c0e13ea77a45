#include "solve/robot_setup/t_pose.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "retarget/human_skeleton.h"
#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/so3.h"
#include "retarget/text.h"
#include "robot/model/composite.h"
#include "solve/ik/box_qp.h"

namespace retarget {
namespace {

Eigen::Matrix3d world_from_bone(const TreeState& posed, const BonePart& bone) {
  const Pose body = posed.world_from_body(bone.part.body);
  return body.rotation.toRotationMatrix() * bone.part.body_from_bone;
}

// The cost of a configuration: differences of the bone axes from the canonical ones, and a
// regularisation.
class TPoseProblem {
 public:
  TPoseProblem(const Robot& robot, const RobotAnatomy& limbs)
      : robot_(robot), limbs_(limbs), parts_(bone_parts(limbs)) {}

  [[nodiscard]] const std::vector<BonePart>& parts() const { return parts_; }
  [[nodiscard]] double cost(const std::vector<double>& qpos) const;
  // The cost without the regularisation.
  [[nodiscard]] double misfit(const std::vector<double>& qpos) const;
  // Computes J'J and J'r in the joint positions.
  void linearise(const std::vector<double>& qpos, Eigen::MatrixXd& hessian,
                 Eigen::VectorXd& gradient) const;

 private:
  // Weights of the X, Y and Z axes. An error of the direction (X) is worse than a twist about it.
  static constexpr std::array<double, 3> kAxisWeight = {2.0, 0.0, 1.0};
  // Weight of the regularisation, which selects the smallest joint motion among equally good poses.
  static constexpr double kStay = 1e-2;

  // An upright torso has priority over the arms.
  [[nodiscard]] double weight_of(const BonePart& part, int column) const {
    constexpr double kTrunk = 10.0;
    const double weight = kAxisWeight[column];
    return part.part.body == limbs_.torso ? kTrunk * weight : weight;
  }

  const Robot& robot_;
  const RobotAnatomy& limbs_;
  std::vector<BonePart> parts_;
};

void TPoseProblem::linearise(const std::vector<double>& qpos, Eigen::MatrixXd& hessian,
                             Eigen::VectorXd& gradient) const {
  const KinematicTree& tree = robot_.tree();
  const TreeState posed(tree, qpos);
  std::vector<Composite> composites(tree.links().size());
  const auto count = static_cast<Eigen::Index>(robot_.joints().size());
  hessian = kStay * kStay * Eigen::MatrixXd::Identity(count, count);
  gradient = Eigen::VectorXd::Zero(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const RobotJoint& joint = robot_.joints()[j];
    gradient[j] = kStay * (kStay * (qpos[joint.qpos_address] - joint.reference));
  }
  for (const BonePart& part : parts_) {
    const Eigen::Matrix3d found = world_from_bone(posed, part);
    const Eigen::Matrix3d wanted = t_pose_of(limbs_, part.bone);
    Composite& sum = composites[tree.attachment(part.part.body).link];
    for (int column = 0; column < 3; ++column) {
      const double weight = weight_of(part, column);
      if (weight == 0.0) continue;
      const Eigen::Vector3d residual = weight * (found.col(column) - wanted.col(column));
      // The derivative of the axis is w x axis.
      const Eigen::Vector3d axis = found.col(column);
      sum.angular += weight * weight * (Eigen::Matrix3d::Identity() - axis * axis.transpose());
      sum.torque += weight * axis.cross(residual);
    }
  }
  const int dofs = tree.dof_count();
  std::vector<double> rows(tree.row_begin().back());
  Eigen::VectorXd slope(dofs);
  Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(dofs, dofs);
  assemble(posed, composites, rows, std::span(slope.data(), slope.size()));
  // The row-major lower triangle is the column-major upper triangle; joints are in tree order.
  write_lower_triangle(tree, rows, curvature.data(), dofs);
  hessian +=
      Eigen::MatrixXd(curvature.selfadjointView<Eigen::Upper>()).bottomRightCorner(count, count);
  gradient += slope.tail(count);
}

double TPoseProblem::cost(const std::vector<double>& qpos) const {
  double cost = misfit(qpos);
  for (const RobotJoint& joint : robot_.joints()) {
    const double away = kStay * (qpos[joint.qpos_address] - joint.reference);
    cost += away * away;
  }
  return cost;
}

double TPoseProblem::misfit(const std::vector<double>& qpos) const {
  const TreeState posed(robot_.tree(), qpos);
  double sum = 0.0;
  for (const BonePart& part : parts_) {
    const Eigen::Matrix3d found = world_from_bone(posed, part);
    const Eigen::Matrix3d away = found - t_pose_of(limbs_, part.bone);
    for (int column = 0; column < 3; ++column) {
      const double weight = weight_of(part, column);
      sum += weight * weight * away.col(column).squaredNorm();
    }
  }
  return sum;
}

// A TPoseProblem with bounds, for damped_least_squares(). `qpos` is the iterate.
class TPoseDescent {
 public:
  TPoseDescent(const Robot& robot, const TPoseProblem& problem, std::vector<double>& qpos)
      : robot_(robot),
        problem_(problem),
        qpos_(qpos),
        system_(static_cast<int>(robot.joints().size())) {}

  [[nodiscard]] double cost() const { return problem_.cost(qpos_); }
  void linearise() { problem_.linearise(qpos_, system_.hessian, system_.gradient); }
  std::optional<double> solve(double damping) {
    const LimitSet& limits = robot_.model_limits();
    for (std::size_t j = 0; j < robot_.joints().size(); ++j) {
      const double position = qpos_[robot_.joints()[j].qpos_address];
      const auto row = static_cast<Eigen::Index>(j);
      system_.lower[row] = limits.lower[j] - position;
      system_.upper[row] = limits.upper[j] - position;
    }
    return system_.solve(damping);
  }
  double try_step(double length) {
    tried_ = qpos_;
    for (Eigen::Index j = 0; j < system_.step.size(); ++j) {
      tried_[robot_.joints()[j].qpos_address] += length * system_.step[j];
    }
    return problem_.cost(tried_);
  }
  void accept() { qpos_.swap(tried_); }
  void reject() {}

 private:
  const Robot& robot_;
  const TPoseProblem& problem_;
  std::vector<double>& qpos_;
  std::vector<double> tried_;
  DenseLeastSquares system_;
};

// @return the final cost. If it is not finite, `qpos` is unchanged.
double minimise(const Robot& robot, const TPoseProblem& problem, std::vector<double>& qpos) {
  constexpr LeastSquaresPolicy kPolicy{.max_steps = 60,
                                       .initial_damping = 1e-2,
                                       .shrink = 0.2,
                                       .growth = 5.0,
                                       .min_damping = 1e-9,
                                       .min_increased = 0.0,
                                       .max_damping = 1e8,
                                       .min_step = 1e-8};
  TPoseDescent descent(robot, problem, qpos);
  return damped_least_squares(descent, kPolicy).cost;
}

// Rotates the first three joints of both limbs of a pair by -90, 0 or 90 degrees.
// @param pattern  the rotations as digits of a base-3 number.
void turn_pair(const Robot& robot, const std::array<Limb, 2>& pair, int pattern,
               std::vector<double>& qpos) {
  constexpr double kQuarterTurn = 1.5707963267948966;
  const LimitSet& limits = robot.model_limits();
  for (std::size_t side = 0; side < 2; ++side) {
    const Limb& limb = pair[side];
    for (int i = 0, code = pattern; i < std::min(limb.middle, 3); ++i, code /= 3) {
      const int joint = limb.joints[i];
      // Mirrored limbs rotate with equal signs about lateral axes, and with opposite signs about
      // other axes.
      const double turn = (code % 3 - 1) * kQuarterTurn;
      const RobotJoint& other = robot.joints()[pair[0].joints[i]];
      const RobotJoint& own = robot.joints()[joint];
      const bool mirrored = limits.lower[joint] + limits.upper[joint] == 0.0 ||
                            limits.lower[joint] == limits.lower[pair[0].joints[i]];
      const double sign = side == 0 || (mirrored && own.axis.dot(other.axis) > 0.0) ? 1.0 : -1.0;
      qpos[own.qpos_address] =
          std::clamp(own.reference + sign * turn, limits.lower[joint], limits.upper[joint]);
    }
  }
}

// A start configuration with straight knees and elbows, and the joints before the elbow rotated by
// a pattern (turn_pair()).
std::vector<double> start(const Robot& robot, const RobotAnatomy& limbs, int pattern) {
  std::vector<double> qpos = reference_configuration(robot);
  const LimitSet& limits = robot.model_limits();
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    for (const Limb& limb : *pair) {
      if (limb.joints.empty()) continue;
      const int middle = limb.joints[limb.middle];
      qpos[robot.joints()[middle].qpos_address] =
          std::clamp(limb.straight, limits.lower[middle], limits.upper[middle]);
    }
  }
  turn_pair(robot, limbs.arms, pattern, qpos);
  return qpos;
}

// All patterns of start(), in the order of the number of rotated joints.
std::vector<int> start_patterns() {
  std::vector<int> patterns(27);
  std::iota(patterns.begin(), patterns.end(), 0);
  const auto turned = [](int code) {
    return static_cast<int>(code % 3 != 1) + static_cast<int>(code / 3 % 3 != 1) +
           static_cast<int>(code / 9 != 1);
  };
  std::ranges::stable_sort(patterns, {}, turned);
  return patterns;
}

std::vector<TPoseResidual> residuals_of(const Robot& robot, const RobotAnatomy& limbs,
                                        const TPoseProblem& problem,
                                        const std::vector<double>& qpos) {
  const TreeState posed(robot.tree(), qpos);
  std::vector<TPoseResidual> residuals;
  for (const BonePart& part : problem.parts()) {
    const Eigen::Matrix3d found = world_from_bone(posed, part);
    TPoseResidual residual{bone_axes_error(found, t_pose_of(limbs, part.bone)), {}};
    residual.bone = bone_name(part.bone);
    residual.body = part.part.body;
    residuals.push_back(residual);
  }
  return residuals;
}

}  // namespace

BoneAxesError bone_axes_error(const Eigen::Matrix3d& axes, const Eigen::Matrix3d& wanted) {
  // Aligns the X axes by the smallest rotation, then measures the angle between the Z axes.
  const Eigen::Vector3d z = rotation_between(axes.col(0), wanted.col(0)) * axes.col(2);
  return {angle_between(axes.col(0), wanted.col(0)), angle_between(z, wanted.col(2))};
}

std::vector<BonePart> bone_parts(const RobotAnatomy& limbs) {
  std::vector<BonePart> parts;
  // A base that carries the arms directly is the chest of an upper body.
  const bool is_chest = !limbs.has_legs && limbs.torso == limbs.pelvis;
  parts.push_back({is_chest ? Bone::kSpine2 : Bone::kHips,
                   {limbs.pelvis, limbs.pelvis_from_hips, Eigen::Vector3d::Zero()}});
  const auto add_limb = [&](const Limb& limb, std::size_t side,
                            const std::array<LimbBone, 3>& bones) {
    parts.push_back({side_bone(kSides[side], bones[0]), limb.upper});
    parts.push_back({side_bone(kSides[side], bones[1]), limb.lower});
    if (limb.end) parts.push_back({side_bone(kSides[side], bones[2]), *limb.end});
  };
  for (std::size_t side = 0; side < 2 && limbs.has_legs; ++side) {
    add_limb(limbs.legs[side], side, {LimbBone::kUpLeg, LimbBone::kLeg, LimbBone::kFootMod});
  }
  if (limbs.torso != limbs.pelvis) {
    parts.push_back(
        {Bone::kSpine2, {limbs.torso, limbs.torso_from_spine2, Eigen::Vector3d::Zero()}});
  }
  for (std::size_t side = 0; side < 2; ++side) {
    add_limb(limbs.arms[side], side, {LimbBone::kArm, LimbBone::kForeArm, LimbBone::kHand});
  }
  if (limbs.head) parts.push_back({Bone::kHead, *limbs.head});
  return parts;
}

Eigen::Matrix3d t_pose_of(const RobotAnatomy& limbs, Bone bone) {
  Eigen::Matrix3d world_from_standing;
  world_from_standing << limbs.forward, limbs.left, Eigen::Vector3d::UnitZ();
  return world_from_standing * canonical_t_pose(bone);
}

std::optional<std::string> t_pose_fault(const Robot& robot, const TPose& t_pose) {
  constexpr double kPerRadian = 180.0 / std::numbers::pi;
  constexpr double kSegment = 25.0 / kPerRadian;
  constexpr double kDirection = 60.0 / kPerRadian;
  constexpr double kTwist = 120.0 / kPerRadian;
  using enum LimbBone;
  for (const TPoseResidual& residual : t_pose.residuals) {
    const auto bone = bone_from_name(residual.bone);
    const auto part = bone ? limb_bone(*bone) : std::nullopt;
    const bool segment = part == kUpLeg || part == kLeg || part == kArm || part == kForeArm;
    const bool turned = segment && residual.twist > kTwist;
    const double at_most = segment || bone == Bone::kSpine2 ? kSegment : kDirection;
    if (residual.direction <= at_most && !turned) continue;
    const double off = turned ? residual.twist : residual.direction;
    return fmt::format("the T-pose cannot be reached: \"{}\" ({}) stays {} degrees off{}",
                       robot.bodies()[residual.body].name, residual.bone,
                       number_text(off * kPerRadian, 0),
                       turned ? " about itself, so that it bends to the wrong side" : "");
  }
  return std::nullopt;
}

TPose solve_t_pose(const Robot& robot, const RobotAnatomy& limbs) {
  constexpr double kNothingLeft = 1e-6;
  const TPoseProblem problem(robot, limbs);
  TPose best;
  best.qpos = reference_configuration(robot);
  double min = minimise(robot, problem, best.qpos);
  const auto try_from = [&](std::vector<double> qpos) {
    const double cost = minimise(robot, problem, qpos);
    // Keeps the first of equally good results, and rejects a cost that is not finite.
    if (!std::isfinite(cost) || cost >= min - 1e-7) return;
    min = cost;
    best.qpos = std::move(qpos);
  };
  for (const int pattern : start_patterns()) {
    if (problem.misfit(best.qpos) < kNothingLeft) break;
    try_from(start(robot, limbs, pattern));
  }
  best.residuals = residuals_of(robot, limbs, problem, best.qpos);
  // An error of half a turn is a stationary point of the cost, so restarts from rotated limbs.
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    if ((*pair)[0].joints.empty()) continue;
    for (const int pattern : start_patterns()) {
      if (!t_pose_fault(robot, best)) return best;
      std::vector<double> qpos = best.qpos;
      turn_pair(robot, *pair, pattern, qpos);
      try_from(std::move(qpos));
      best.residuals = residuals_of(robot, limbs, problem, best.qpos);
    }
  }
  return best;
}

}  // namespace retarget
