#include "solve/targets/robot_as_human.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/try.h"
#include "retarget/human_skeleton.h"
#include "robot/model/sole_ends.h"
#include "solve/targets/limb_lengths.h"
#include "solve/targets/trunk_aim.h"

namespace retarget {
namespace {

using enum LimbBone;

// Proportions of LAFAN1's human: forearm to upper arm, toes ahead of the ankle to leg, head above
// the shoulders to trunk.
constexpr double kForearmShare = 0.764, kToeShare = 0.2, kHeadShare = 0.35;

class HumanMaker {
 public:
  HumanMaker(const Robot& robot, const ResolvedConfig& config, const RobotLimbs& limbs)
      : robot_(robot),
        config_(config),
        limbs_(limbs),
        zero_(robot.tree(), robot.zero_configuration()) {}

  Result<void> make();

  std::vector<RobotAsHuman::Part> parts;
  std::array<std::optional<FootSole>, 2> soles;

 private:
  // The axes of a bone in the frame of a body.
  struct Axes {
    int body = -1;
    Eigen::Quaterniond body_from_bone = Eigen::Quaterniond::Identity();
  };
  [[nodiscard]] static Axes axes_of(const ConfigTask& task) {
    return {task.body, task.rotation_offset.conjugate()};
  }
  [[nodiscard]] std::optional<Axes> axes_of(Bone bone) const {
    const ConfigTask* const task = config_.find_task(bone);
    if (task == nullptr || task->body < 0) return std::nullopt;
    return axes_of(*task);
  }
  // Converts a world position of the zero configuration to the frame of a body.
  [[nodiscard]] Eigen::Vector3d in_body(int body, const Eigen::Vector3d& place) const {
    return zero_.world_from_body(body).inverse() * place;
  }
  [[nodiscard]] Eigen::Vector3d waist(int pelvis, int torso) const;
  [[nodiscard]] std::optional<FootSole> sole_of(Side side, int foot,
                                                const Pose& body_from_sole) const;
  // @param carrier  the body that carries the bone.
  // @param place    position in this body.
  void add(Bone bone, const Axes& axes, int carrier, const Eigen::Vector3d& place) {
    parts.push_back({bone, axes.body, carrier, axes.body_from_bone, place});
  }
  void add_trunk(const Axes& hips);
  void add_leg(Side side);
  void add_arm(Side side);

  const Robot& robot_;
  const ResolvedConfig& config_;
  const RobotLimbs& limbs_;
  TreeState zero_;
};

// Common point of the joints between pelvis and torso; without joints, the middle of the trunk.
Eigen::Vector3d HumanMaker::waist(int pelvis, int torso) const {
  const KinematicTree& tree = robot_.tree();
  const auto carriers = [&](int body) {
    const auto dofs = tree.carriers(KinematicTree::dof_of(tree.attachment(body).link));
    return std::vector<int>(dofs.begin(), dofs.end());
  };
  const std::vector<int> to_pelvis = carriers(pelvis), to_torso = carriers(torso);
  std::vector<int> joints;
  const auto add_those_missing = [&](const std::vector<int>& dofs, const std::vector<int>& from) {
    for (const int dof : dofs) {
      if (dof < KinematicTree::kBaseDofs || std::ranges::count(from, dof) > 0) continue;
      joints.push_back(
          tree.links()[static_cast<std::size_t>(dof - KinematicTree::dof_of(0))].joint);
    }
  };
  add_those_missing(to_pelvis, to_torso);
  add_those_missing(to_torso, to_pelvis);
  if (joints.empty()) return 0.5 * (limbs_.hip_centre + limbs_.shoulder_centre);
  return common_point(zero_, joints);
}

void HumanMaker::add_trunk(const Axes& hips) {
  const ConfigTask* const spine = torso_task(config_);
  const Axes torso = spine == nullptr || spine->body < 0 ? hips : axes_of(*spine);
  const auto add_at = [&](Bone bone, const Axes& axes, int carrier, const Eigen::Vector3d& place) {
    add(bone, axes, carrier, in_body(carrier, place));
  };
  const Eigen::Vector3d bend = waist(hips.body, torso.body);
  for (const Bone bone : {Bone::kSpine, Bone::kSpine1, Bone::kSpine2}) {
    add_at(bone, torso, torso.body, bend);
  }
  const Eigen::Vector3d chord = limbs_.shoulder_centre - limbs_.hip_centre;
  add_at(Bone::kNeck, torso, torso.body, limbs_.shoulder_centre + 0.5 * kHeadShare * chord);
  const Eigen::Vector3d head = limbs_.shoulder_centre + kHeadShare * chord;
  add_at(Bone::kHead, axes_of(Bone::kHead).value_or(torso), torso.body, head);
  // If the axes of a hip or shoulder do not intersect, its centre moves relative to the limb.
  // Therefore the centre is fixed to the pelvis or torso.
  for (const Side side : kSides) {
    const double sign = side == Side::kLeft ? 0.5 : -0.5;
    const Bone thigh = side_bone(side, kUpLeg), arm = side_bone(side, kArm);
    add_at(thigh, *axes_of(thigh), hips.body, limbs_.hip_centre + sign * limbs_.hip_line);
    add_at(arm, *axes_of(arm), torso.body, limbs_.shoulder_centre + sign * limbs_.shoulder_line);
  }
}

// The sole in the axes of FootMod, with the ankle as the origin.
std::optional<FootSole> HumanMaker::sole_of(Side side, int foot, const Pose& body_from_sole) const {
  const std::string_view name = side == Side::kLeft ? "left" : "right";
  for (const Sole& sole : robot_.profile().soles) {
    // The sole must be fixed to the foot.
    if (sole.side != name || robot_.tree().carrier(sole.body) != robot_.tree().carrier(foot))
      continue;
    const auto shape = sole_shape(sole);
    if (!shape) continue;
    const auto placed = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
      return body_from_sole.inverse() * in_body(foot, zero_.world_from_body(sole.body) * point);
    };
    const auto end = [&](int which) {
      const SolePoints& of_end = shape->ends[static_cast<std::size_t>(which)];
      return SoleEnd{placed(of_end.middle), placed(of_end.tip)};
    };
    return FootSole{end(kSoleHeel), end(kSoleToe)};
  }
  return std::nullopt;
}

void HumanMaker::add_leg(Side side) {
  const Bone shin = side_bone(side, kLeg);
  const auto shin_axes = axes_of(shin);
  add(shin, *shin_axes, shin_axes->body, limbs_.body_from_joint[shin]);
  const Bone foot = side_bone(side, kFoot), sole = side_bone(side, kFootMod);
  const Eigen::Quaterniond sole_from_foot(canonical_t_pose(sole).transpose() *
                                          canonical_t_pose(foot));
  // A robot's foot follows Foot or FootMod. The axes of the other bone are derived.
  const auto as_sole = axes_of(sole), as_foot = axes_of(foot);
  const int body = as_sole ? as_sole->body : as_foot->body;
  const Eigen::Vector3d& ankle = limbs_.body_from_joint[as_sole ? sole : foot];
  const Pose body_from_sole = {
      as_sole ? as_sole->body_from_bone : as_foot->body_from_bone * sole_from_foot.conjugate(),
      ankle};
  add(foot, Axes{body, body_from_sole.rotation * sole_from_foot}, body, ankle);
  const std::size_t index = side == Side::kLeft ? 0 : 1;
  soles[index] = sole_of(side, body, body_from_sole);
  const Eigen::Vector3d toe =
      soles[index] ? soles[index]->toe.middle
                   : Eigen::Vector3d(sole_from_foot *
                                     (kToeShare * limbs_.lengths.leg * Eigen::Vector3d::UnitX()));
  add(side_bone(side, kToe), Axes{body, body_from_sole.rotation}, body, body_from_sole * toe);
}

void HumanMaker::add_arm(Side side) {
  const Bone forearm = side_bone(side, kForeArm), hand = side_bone(side, kHand);
  const Axes lower = *axes_of(forearm);
  const Eigen::Vector3d& elbow = limbs_.body_from_joint[forearm];
  add(forearm, lower, lower.body, elbow);
  const auto axes = axes_of(hand);
  if (axes && limbs_.forearms) {
    add(hand, *axes, axes->body, limbs_.body_from_joint[hand]);
    return;
  }
  const Eigen::Vector3d along = lower.body_from_bone * Eigen::Vector3d::UnitX();
  add(hand, lower, lower.body, elbow + kForearmShare * limbs_.lengths.arm * along);
}

Result<void> HumanMaker::make() {
  const auto hips = axes_of(Bone::kHips);
  if (!hips) {
    return config_failure(config_.file,
                          "no body follows Hips: the robot cannot be used as a human");
  }
  add(Bone::kHips, *hips, hips->body, limbs_.body_from_joint[Bone::kHips]);
  add_trunk(*hips);
  for (const Side side : kSides) {
    add_leg(side);
    add_arm(side);
  }
  return {};
}

}  // namespace

Result<RobotAsHuman> RobotAsHuman::make(const Robot& robot, const ResolvedConfig& config) {
  TRY_ASSIGN(const RobotLimbs limbs, robot_limbs(robot, config));
  HumanMaker maker(robot, config, limbs);
  RobotAsHuman human;
  TRY(maker.make());
  human.parts_ = std::move(maker.parts);
  human.soles_ = std::move(maker.soles);
  return human;
}

RobotHuman RobotAsHuman::human_of(const RobotClip& motion) const {
  RobotHuman human;
  human.robot = motion.robot().name();
  human.rate = motion.rate();
  human.frame_count = motion.frame_count();
  human.soles = soles_;
  for (const Part& part : parts_) human.has[part.bone] = true;
  human.poses = [this, &motion, posed = TreeState(motion.robot().tree())](
                    int frame, HumanPose& world_from_bone) mutable {
    posed.update(motion.qpos(frame));
    pose(posed, world_from_bone);
  };
  pose(TreeState(motion.robot().tree(), motion.robot().zero_configuration()), human.standing);
  return human;
}

void RobotAsHuman::pose(const TreeState& posed, HumanPose& world_from_bone) const {
  for (const Part& part : parts_) {
    const Pose turning = posed.world_from_body(part.turning);
    const Pose carrying = posed.world_from_body(part.carrying);
    world_from_bone[part.bone] = {(turning.rotation * part.turning_from_bone).normalized(),
                                  carrying * part.place};
  }
}

}  // namespace retarget
