#include "solve/targets/targets.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>

#include "base/try.h"
#include "retarget/human_skeleton.h"
#include "retarget/so3.h"
#include "retarget/text.h"

namespace retarget {

HeldBase::HeldBase(const Robot& robot, const ResolvedConfig& config) : root_(config.root_bone) {
  std::vector<Pose> world_from_body(robot.bodies().size());
  forward_kinematics(robot, robot.zero_configuration(), world_from_body);
  const Pose& base = world_from_body[static_cast<std::size_t>(config.root_body)];
  place_ = base.translation;
  const Eigen::Quaterniond standing(canonical_t_pose(root_));
  standing_from_root_ = standing.conjugate();
  const ConfigTask* task = config.find_task(root_);
  const Eigen::Quaterniond offset =
      task == nullptr ? Eigen::Quaterniond::Identity() : task->rotation_offset;
  base_from_standing_ = (base.rotation * (standing * offset).conjugate()).normalized();
}

Eigen::Quaterniond HeldBase::turn(const HumanPose& world_from_bone) const {
  const Eigen::Quaterniond turned =
      (world_from_bone[root_].rotation * standing_from_root_).normalized();
  const Eigen::Quaterniond frame = root_ == Bone::kHips ? turn_about_vertical(turned) : turned;
  return (base_from_standing_ * frame.conjugate()).normalized();
}

HumanClip seen_by(const HeldBase& base, Bone root, HumanClip human) {
  for (HumanPose& pose : human.world_from_bone) {
    const Eigen::Quaterniond turn = base.turn(pose);
    const Eigen::Vector3d from = pose[root].translation;
    for (const Bone bone : kAllBones) {
      pose[bone] = {(turn * pose[bone].rotation).normalized(),
                    base.place() + turn * (pose[bone].translation - from)};
    }
  }
  return human;
}

namespace {

constexpr double kMinLength = 1e-6;  // Metres; also used for a sine.
constexpr double kOwnShare = 0.1;    // Share of the upper bone's own axis; the sine of a bend of 6
                                     // degrees.

// Rotation with X along a direction and Z as close to the hinge as possible.
std::optional<Eigen::Quaterniond> bone_along(const Eigen::Vector3d& along,
                                             const Eigen::Vector3d& hinge) {
  const Eigen::Vector3d y = hinge.cross(along);
  const double clear = y.norm();
  if (!(clear > kMinLength)) return std::nullopt;
  Eigen::Matrix3d axes;
  axes.col(0) = along;
  axes.col(1) = y / clear;
  axes.col(2) = along.cross(axes.col(1));
  return Eigen::Quaterniond(axes);
}

}  // namespace

std::optional<LimbAim> aim_limb(const Pose& upper, const Pose& lower, const Pose& end) {
  const Eigen::Vector3d first = lower.translation - upper.translation;
  const Eigen::Vector3d second = end.translation - lower.translation;
  const double first_length = first.norm(), second_length = second.norm();
  if (!(first_length > kMinLength && second_length > kMinLength)) return std::nullopt;
  const Eigen::Vector3d u = first / first_length, f = second / second_length;
  const Eigen::Vector3d own = upper.rotation.normalized() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d plane = -u.cross(f);
  // A hinge cannot bend backwards. Removes that part, so that such a limb is straight.
  const double back = std::min(0.0, plane.dot(own));
  const Eigen::Vector3d hinge = (kOwnShare - back) * own + plane;
  const auto first_turn = bone_along(u, hinge), second_turn = bone_along(f, hinge);
  if (!first_turn || !second_turn) return std::nullopt;
  return LimbAim{*first_turn, *second_turn};
}

namespace {

using enum LimbBone;

// Vector from the right hip to the left one.
Eigen::Vector3d hip_line(const HumanPose& world_from_bone) {
  return world_from_bone[Bone::kLeftUpLeg].translation -
         world_from_bone[Bone::kRightUpLeg].translation;
}

bool is_of_leg(std::optional<LimbBone> part) {
  return part == kUpLeg || part == kLeg || part == kFoot || part == kToe || part == kFootMod;
}

}  // namespace

TargetBuilder::TargetBuilder(const ResolvedConfig& config, double height, ScaleRule scale) {
  constexpr double kPublishedHeight = 1.75;
  const double ratio =
      scale == ScaleRule::kTable
          ? height / config.human_height_assumption
          : kPublishedHeight / config.human_height_assumption * (kPublishedHeight / height);
  add_rules(config);
  for (Rule& rule : rules_) rule.scale = config.scales[rule.bone] * ratio;
}

TargetBuilder::TargetBuilder(const ResolvedConfig& config, const RobotLimbs& robot,
                             const LimbLengths& human, std::optional<TrunkAim> trunk)
    : by_limbs_(true),
      leg_scale_(robot.lengths.leg / human.leg),
      trunk_scale_(robot.lengths.trunk / human.trunk),
      trunk_(std::move(trunk)) {
  constexpr double kAnkleHeightPerLeg = 0.039 / 0.491;
  const double human_ankle = kAnkleHeightPerLeg * human.leg * leg_scale_;
  lift_ = robot.ankle_height.value_or(human_ankle) - human_ankle;
  add_rules(config);
  const Eigen::Vector3d ground(0.0, 0.0, config.ground_height);
  for (Rule& rule : rules_) {
    // The table's position offsets compensate for its scales, which are not used here.
    rule.position_offset = -ground - robot.body_from_joint[rule.bone];
    const std::optional<LimbBone> part = limb_bone(rule.bone);
    if (is_of_leg(part)) {
      rule.scale = leg_scale_;
    } else if (part == kForeArm || part == kHand) {
      rule.scale = robot.lengths.arm / human.arm;
      rule.pivot = side_bone(side_of(rule.bone), kArm);
    } else {
      rule.scale = trunk_scale_;
    }
  }
  if (trunk_) aim_limbs(config);
}

void TargetBuilder::aim_limbs(const ResolvedConfig& config) {
  const ConfigTask* const torso = torso_task(config);
  find_parts(torso == nullptr ? std::nullopt : std::optional(torso->bone));
}

// Determines which rules belong to pelvis, torso and limbs, whose rotations may come from lines.
void TargetBuilder::find_parts(std::optional<Bone> torso) {
  for (Rule& rule : rules_) {
    const Side side = side_of(rule.bone);
    const std::optional<LimbBone> part = limb_bone(rule.bone);
    rule.of_arm = part == kArm || part == kForeArm || part == kHand;
    if (is_of_leg(part)) rule.leg_side = side == Side::kLeft ? 1.0 : -1.0;
    if (rule.bone == Bone::kHips) rule.part = Part::kPelvis;
    if (rule.bone == torso) rule.part = Part::kTorso;
    for (const auto& [upper, lower, end] :
         {std::array{kArm, kForeArm, kHand}, std::array{kUpLeg, kLeg, kFoot}}) {
      if (part != upper && part != lower) continue;
      rule.part = part == upper ? Part::kUpperLimb : Part::kLowerLimb;
      rule.limb = {side_bone(side, upper), side_bone(side, lower), side_bone(side, end)};
    }
  }
}

Eigen::Quaterniond TargetBuilder::rotation_of(const Rule& rule, const HumanPose& world_from_bone,
                                              const std::optional<TrunkAim::Aimed>& aimed) const {
  if (aimed && rule.part == Part::kPelvis) return aimed->world_from_pelvis;
  if (aimed && rule.part == Part::kTorso) return aimed->world_from_torso;
  if (aims_limbs_ && (rule.part == Part::kUpperLimb || rule.part == Part::kLowerLimb)) {
    const auto& [upper, lower, end] = rule.limb;
    if (const auto limb =
            aim_limb(world_from_bone[upper], world_from_bone[lower], world_from_bone[end])) {
      const bool is_upper = rule.part == Part::kUpperLimb;
      return ((is_upper ? limb->upper : limb->lower) * rule.bone_from_target).normalized();
    }
  }
  return offset_rotation(world_from_bone[rule.bone].rotation, rule.bone_from_target);
}

void TargetBuilder::add_rules(const ResolvedConfig& config) {
  const Eigen::Vector3d ground(0.0, 0.0, config.ground_height);
  const auto add = [&](Bone bone) {
    if (target_of(bone) >= 0) return;
    Rule rule{.bone = bone,
              .scale = 1.0,
              .position_offset = -ground,
              .bone_from_target = Eigen::Quaterniond::Identity()};
    // find_task() prefers table 1, even if it is not used.
    if (const ConfigTask* task = config.find_task(bone); task != nullptr && task->has_weight()) {
      rule.position_offset += task->position_offset;
      rule.bone_from_target = task->rotation_offset;
    }
    rules_.push_back(rule);
  };
  add(config.root_bone);
  for (const auto& [used, tasks] : config.match_tables) {
    if (!used) continue;
    for (const ConfigTask& task : tasks) {
      if (task.has_weight()) add(task.bone);
    }
  }
}

std::vector<Bone> TargetBuilder::bones() const {
  std::vector<Bone> bones;
  for (const Rule& rule : rules_) bones.push_back(rule.bone);
  return bones;
}

int TargetBuilder::target_of(Bone bone) const {
  const auto found = std::ranges::find(rules_, bone, &Rule::bone);
  return found == rules_.end() ? -1 : static_cast<int>(found - rules_.begin());
}

Eigen::Vector3d TargetBuilder::scaled_limb(const Rule& rule,
                                           const HumanPose& world_from_bone) const {
  const Eigen::Vector3d hips = 0.5 * (world_from_bone[Bone::kLeftUpLeg].translation +
                                      world_from_bone[Bone::kRightUpLeg].translation);
  Eigen::Vector3d scaled_hips = leg_scale_ * hips + Eigen::Vector3d(0.0, 0.0, lift_);
  const Eigen::Vector3d& bone = world_from_bone[rule.bone].translation;
  if (&rule == &rules_.front()) return scaled_hips;
  if (!rule.pivot) return scaled_hips + rule.scale * (bone - hips);
  const Eigen::Vector3d& pivot = world_from_bone[*rule.pivot].translation;
  return scaled_hips + trunk_scale_ * (pivot - hips) + rule.scale * (bone - pivot);
}

void TargetBuilder::build(const HumanPose& world_from_bone,
                          std::span<Pose> world_from_target) const {
  const Eigen::Vector3d root = world_from_bone[rules_.front().bone].translation;
  const Eigen::Vector3d scaled_root = rules_.front().scale * root;
  const auto aimed = aim_trunk(world_from_bone);
  Eigen::Vector3d shoulders_moved = Eigen::Vector3d::Zero(), left_hip_moved = shoulders_moved;
  if (aimed) {
    shoulders_moved = aimed->chord - trunk_scale_ * trunk_lines(world_from_bone).chord;
    left_hip_moved = 0.5 * (aimed->hip_line - leg_scale_ * hip_line(world_from_bone));
  }
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    const Rule& rule = rules_[i];
    const Pose& bone = world_from_bone[rule.bone];
    Eigen::Vector3d scaled = scaled_root;
    if (by_limbs_) {
      scaled = scaled_limb(rule, world_from_bone);
    } else if (i > 0) {
      scaled = scaled_about_root(bone.translation, rule.scale, root, scaled_root);
    }
    const Eigen::Quaterniond rotation = rotation_of(rule, world_from_bone, aimed);
    if (rule.of_arm) scaled += shoulders_moved;
    scaled += rule.leg_side * left_hip_moved;
    world_from_target[i] = offset_target(rotation, scaled, rule.position_offset);
  }
  if (!held_) return;
  const Eigen::Quaterniond turn = held_->turn(world_from_bone);
  const Eigen::Vector3d from = world_from_target[0].translation;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    Pose& target = world_from_target[i];
    target = {(turn * target.rotation).normalized(),
              held_->place() + turn * (target.translation - from)};
  }
}

bool TargetBuilder::is_of_trunk(int target) const {
  const Part part = rules_[static_cast<std::size_t>(target)].part;
  return part == Part::kPelvis || part == Part::kTorso;
}

Eigen::Quaterniond TargetBuilder::rotation(int target, const HumanPose& world_from_bone,
                                           const std::optional<TrunkAim::Aimed>& trunk) const {
  const Rule& rule = rules_[static_cast<std::size_t>(target)];
  const Eigen::Quaterniond rotation = rotation_of(rule, world_from_bone, trunk);
  return held_ ? (held_->turn(world_from_bone) * rotation).normalized() : rotation;
}

std::shared_ptr<const IkProblem> make_problem(std::shared_ptr<const Robot> robot,
                                              const ResolvedConfig& config,
                                              const TargetBuilder& targets,
                                              const LimitSet& limits) {
  auto problem = std::make_shared<IkProblem>();
  for (const auto& [used, tasks] : config.match_tables) {
    if (!used) continue;
    IkPass pass;
    for (const ConfigTask& task : tasks) {
      if (!task.has_weight()) continue;
      const double share = task.rotation_is_guess ? kGuessedRotationShare : 1.0;
      pass.push_back({task.body, targets.target_of(task.bone), task.position_weight,
                      share * task.rotation_weight});
    }
    problem->passes.push_back(std::move(pass));
  }
  const auto joints = static_cast<Eigen::Index>(robot->joints().size());
  problem->lower = Eigen::Map<const Eigen::VectorXd>(limits.lower.data(), joints);
  problem->upper = Eigen::Map<const Eigen::VectorXd>(limits.upper.data(), joints);
  problem->robot = std::move(robot);
  return problem;
}

namespace {

// Reports the mapped bones that the source lacks, and the bones that it has.
Result<void> check_bones(const HumanClipInfo& human, const TargetBuilder& targets,
                         const std::string& config) {
  std::vector<std::string> missing;
  for (const Bone bone : targets.bones()) {
    if (!human.has(bone)) missing.emplace_back(bone_name(bone));
  }
  if (missing.empty()) return {};
  return input_failure(
      {},
      fmt::format("the skeleton has no joint for the bone{} {}, which the configuration "
                  "{} uses",
                  missing.size() == 1 ? "" : "s", list_names(missing), config),
      "the file has " + list_names(human.source_joints));
}

Result<LimbLengths> measured_human(const HumanClipInfo& human, const HumanPoseSource& poses,
                                   bool forearms) {
  for (const Bone bone : kMeasuredBones) {
    if (human.has(bone)) continue;
    return input_failure(
        {}, fmt::format("limbs cannot be measured: no joint found for {}", bone_name(bone)),
        kOtherScaleHint);
  }
  if (const auto& built = human.built) {
    return LimbLengths{built->leg, built->upper_arm + (forearms ? built->forearm : 0.0),
                       built->trunk.norm()};
  }
  HumanPose world_from_bone;
  poses(0, world_from_bone);
  const LimbLengths lengths = human_limb_lengths(world_from_bone, forearms);
  if (lengths.leg > 0.0 && lengths.arm > 0.0 && lengths.trunk > 0.0) return lengths;
  return input_failure({}, "a limb of the body has zero length", kOtherScaleHint);
}

std::optional<TrunkAim> make_trunk_aim(const HumanClipInfo& human, const HumanPoseSource& poses,
                                       const Robot& robot, const ResolvedConfig& config,
                                       const RobotLimbs& limbs, const LimitSet& limits) {
  auto trunk = robot_trunk(robot, config, limbs, limits);
  const ConfigTask* const hips = config.find_task(Bone::kHips);
  if (!trunk || hips == nullptr) return std::nullopt;
  TrunkAim aim(std::move(*trunk), standing_trunk_lines(human, poses), hips->rotation_offset);
  if (human.built) aim.follow_robot();
  return aim;
}

}  // namespace

Result<TargetBuilder> make_targets(const HumanClipInfo& human, const HumanPoseSource& poses,
                                   const Robot& robot, const ResolvedConfig& config,
                                   ScaleRule scale, TrunkRule trunk, const LimitSet* limits) {
  const double height = scale == ScaleRule::kTable ? human.height : human.size;
  TargetBuilder targets(config, height, scale);
  TRY(check_bones(human, targets, config.file));
  if (robot.fixed_base()) {
    targets.hold(HeldBase(robot, config));
    if (trunk == TrunkRule::kLines && !human.built) targets.aim_limbs(config);
    return targets;
  }
  if (scale != ScaleRule::kLimbs || human.frame_count == 0) return targets;
  TRY_ASSIGN(const RobotLimbs limbs, robot_limbs(robot, config));
  TRY_ASSIGN(const LimbLengths body, measured_human(human, poses, limbs.forearms));
  TargetBuilder by_limbs(config, limbs, body,
                         trunk == TrunkRule::kLines
                             ? make_trunk_aim(human, poses, robot, config, limbs,
                                              limits == nullptr ? robot.model_limits() : *limits)
                             : std::nullopt);
  if (human.built) by_limbs.keep_bones();
  return by_limbs;
}

}  // namespace retarget
