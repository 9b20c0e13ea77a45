#include "rig/t_pose.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "base/number_text.h"

#include "human/canonical_pose.h"
#include "ik/box_qp.h"
#include "math/so3.h"
#include "retarget/human.h"
#include "retarget/pose.h"
#include "robot/composite.h"
#include "robot/kinematic_tree.h"

namespace retarget {
namespace {

Eigen::Matrix3d world_from_bone(const TreeState& posed, const BonePart& bone) {
  const Pose body = posed.world_from_body(bone.part.body);
  return body.rotation.toRotationMatrix() * bone.part.body_from_bone;
}

// axes of bones against the canonical ones
class TPoseProblem {
 public:
  TPoseProblem(const Robot& robot, const RobotAnatomy& limbs)
      : robot_(robot), limbs_(limbs), parts_(bone_parts(limbs)) {}

  [[nodiscard]] const std::vector<BonePart>& parts() const { return parts_; }
  [[nodiscard]] double cost(const std::vector<double>& qpos) const;
  // what of the cost the bones are to blame for
  [[nodiscard]] double misfit(const std::vector<double>& qpos) const;
  // adds up J'J and J'r over the joints; gives the cost
  double linearise(const std::vector<double>& qpos, Eigen::MatrixXd& hessian,
                   Eigen::VectorXd& gradient) const;

 private:
  // directions matter more than twists: a limb that points elsewhere is worse than one that is turned
  static constexpr std::array<double, 3> kAxisWeight = {2.0, 0.0, 1.0};
  // of poses that are equally good the one with the least turns
  static constexpr double kStay = 1e-2;

  // a torso that stands straight goes before arms that reach out
  [[nodiscard]] double weight_of(const BonePart& part, int column) const {
    constexpr double kTrunk = 10.0;
    const double weight = kAxisWeight[column];
    return part.part.body == limbs_.torso ? kTrunk * weight : weight;
  }

  const Robot& robot_;
  const RobotAnatomy& limbs_;
  std::vector<BonePart> parts_;
};

double TPoseProblem::linearise(const std::vector<double>& qpos, Eigen::MatrixXd& hessian,
                               Eigen::VectorXd& gradient) const {
  const KinematicTree& tree = robot_.tree();
  const TreeState posed(tree, qpos);
  std::vector<Composite> composites(tree.links().size());
  const auto count = static_cast<Eigen::Index>(robot_.joints().size());
  hessian = kStay * kStay * Eigen::MatrixXd::Identity(count, count);
  gradient = Eigen::VectorXd::Zero(count);
  double cost = 0.0;
  for (Eigen::Index j = 0; j < count; ++j) {
    const RobotJoint& joint = robot_.joints()[j];
    const double away = kStay * (qpos[joint.qpos_address] - joint.reference);
    gradient[j] = kStay * away;
    cost += away * away;
  }
  for (const BonePart& part : parts_) {
    const Eigen::Matrix3d found = world_from_bone(posed, part);
    const Eigen::Matrix3d wanted = t_pose_of(limbs_, part.bone);
    Composite& sum = composites[tree.attachment(part.part.body).link];
    for (int column = 0; column < 3; ++column) {
      const double weight = weight_of(part, column);
      if (weight == 0.0) continue;
      const Eigen::Vector3d residual = weight * (found.col(column) - wanted.col(column));
      cost += residual.squaredNorm();
      // the axis changes with w x axis
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
  // by column what is written by row: the upper triangle; joints come in the tree's order
  write_lower_triangle(tree, rows, curvature.data(), dofs);
  hessian +=
      Eigen::MatrixXd(curvature.selfadjointView<Eigen::Upper>()).bottomRightCorner(count, count);
  gradient += slope.tail(count);
  return cost;
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

double minimise(const Robot& robot, const TPoseProblem& problem, std::vector<double>& qpos) {
  constexpr int kMaxSteps = 60;
  constexpr double kConverged = 1e-8;
  const LimitSet& limits = robot.model_limits();
  const auto count = static_cast<Eigen::Index>(robot.joints().size());
  Eigen::MatrixXd hessian, damped;
  Eigen::VectorXd gradient, lower(count), upper(count);
  Eigen::VectorXd step = Eigen::VectorXd::Zero(count);
  BoxQp qp(static_cast<int>(count));
  double damping = 1e-2;
  double cost = problem.linearise(qpos, hessian, gradient);
  for (int n = 0; n < kMaxSteps && damping < 1e8; ++n) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const auto joint = static_cast<std::size_t>(j);
      const double position = qpos[robot.joints()[joint].qpos_address];
      lower[j] = limits.lower[joint] - position;
      upper[j] = limits.upper[joint] - position;
    }
    damped = hessian;
    damped.diagonal().array() += damping;
    qp.solve(damped, gradient, lower, upper, step);
    std::vector<double> next = qpos;
    for (Eigen::Index j = 0; j < count; ++j) {
      next[robot.joints()[j].qpos_address] += step[j];
    }
    if (problem.cost(next) < cost) {
      qpos = std::move(next);
      cost = problem.linearise(qpos, hessian, gradient);
      damping = std::max(0.2 * damping, 1e-9);
      if (step.norm() < kConverged) break;
    } else {
      damping *= 5.0;
      if (step.norm() < kConverged) break;
    }
  }
  return cost;
}

// knees and elbows straight; the joints before the elbow turned by a pattern of quarter turns
std::vector<double> start(const Robot& robot, const RobotAnatomy& limbs, int pattern) {
  constexpr double kQuarterTurn = 1.5707963267948966;
  std::vector<double> qpos = reference_configuration(robot);
  const LimitSet& limits = robot.model_limits();
  const auto set = [&](int joint, double position) {
    qpos[robot.joints()[joint].qpos_address] =
        std::clamp(position, limits.lower[joint], limits.upper[joint]);
  };
  for (const auto* pair : {&limbs.legs, &limbs.arms}) {
    for (const Limb& limb : *pair) {
      if (!limb.joints.empty()) set(limb.joints[limb.middle], limb.straight);
    }
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const Limb& arm = limbs.arms[side];
    for (int i = 0, code = pattern; i < std::min(arm.middle, 3); ++i, code /= 3) {
      const int joint = arm.joints[i];
      // mirror images turn the same way where the axis lies across, else the other way
      const double turn = (code % 3 - 1) * kQuarterTurn;
      const RobotJoint& other = robot.joints()[limbs.arms[0].joints[i]];
      const RobotJoint& own = robot.joints()[joint];
      const bool mirrored = limits.lower[joint] + limits.upper[joint] == 0.0 ||
                            limits.lower[joint] == limits.lower[limbs.arms[0].joints[i]];
      const double sign = side == 0 || (mirrored && own.axis.dot(other.axis) > 0.0) ? 1.0 : -1.0;
      set(joint, own.reference + sign * turn);
    }
  }
  return qpos;
}

// start's patterns, those that turn few joints first
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

}  // namespace

BoneAxesError bone_axes_error(const Eigen::Matrix3d& axes, const Eigen::Matrix3d& wanted) {
  // the least turn that brings X into place, then the angle between the Z axes
  const Eigen::Vector3d z = rotation_between(axes.col(0), wanted.col(0)) * axes.col(2);
  return {angle_between(axes.col(0), wanted.col(0)), angle_between(z, wanted.col(2))};
}

std::vector<BonePart> bone_parts(const RobotAnatomy& limbs) {
  std::vector<BonePart> parts;
  // a base that carries the arms itself is the chest of an upper body
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
  constexpr double kDirection = 60.0 / kPerRadian;
  constexpr double kTwist = 120.0 / kPerRadian;
  using enum LimbBone;
  for (const TPoseResidual& residual : t_pose.residuals) {
    const auto bone = bone_from_name(residual.bone);
    const auto part = bone ? limb_bone(*bone) : std::nullopt;
    const bool segment = part == kUpLeg || part == kLeg || part == kArm || part == kForeArm;
    const bool turned = segment && residual.twist > kTwist;
    if (residual.direction <= kDirection && !turned) continue;
    const double off = turned ? residual.twist : residual.direction;
    return fmt::format("the T-pose cannot be reached: \"{}\" ({}) stays {} degrees off{}",
                       robot.bodies()[residual.body].name, residual.bone,
                       number_text(off * kPerRadian, 0),
                       turned ? " about itself, so that it bends to the wrong side" : "");
  }
  return std::nullopt;
}

TPose solve_t_pose(const Robot& robot, const RobotAnatomy& limbs) {
  const TPoseProblem problem(robot, limbs);
  TPose best;
  best.qpos = reference_configuration(robot);
  double min = minimise(robot, problem, best.qpos);
  for (const int pattern : start_patterns()) {
    // nothing is left to gain
    if (problem.misfit(best.qpos) < 1e-6) break;
    std::vector<double> qpos = start(robot, limbs, pattern);
    const double cost = minimise(robot, problem, qpos);
    // of results that are equally good the one that is found first
    if (cost >= min - 1e-7) continue;
    min = cost;
    best.qpos = std::move(qpos);
  }
  const TreeState posed(robot.tree(), best.qpos);
  for (const BonePart& part : problem.parts()) {
    const Eigen::Matrix3d found = world_from_bone(posed, part);
    TPoseResidual residual{bone_axes_error(found, t_pose_of(limbs, part.bone)), {}};
    residual.bone = bone_name(part.bone);
    residual.body = part.part.body;
    best.residuals.push_back(residual);
  }
  return best;
}

}  // namespace retarget
