#include "solve/robot_setup/check_robot.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "retarget/error.h"
#include "retarget/human.h"
#include "retarget/kinematic_tree.h"
#include "retarget/pose.h"
#include "retarget/text.h"
#include "robot/anatomy/bare_robot.h"
#include "robot/anatomy/branches.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/overlaps.h"
#include "solve/robot_setup/check_profile.h"
#include "solve/robot_setup/derive_config.h"
#include "solve/robot_setup/describe_robot.h"
#include "solve/robot_setup/format_model.h"
#include "solve/robot_setup/import_robot.h"
#include "solve/robot_setup/self_test.h"
#include "solve/robot_setup/t_pose.h"
#include "solve/targets/check_offsets.h"
#include "solve/targets/targets.h"

namespace retarget {
namespace {

constexpr double kOddOffset = 8.0 * (std::numbers::pi / 180.0);
// Distances of a foot's target beyond the leg's reach for a note and for an error, fraction of the
// leg's length.
constexpr double kOddReach = 0.03;
constexpr double kWrongReach = 0.25;

const ConfigTask* task_of(const ResolvedConfig::Table& table, Bone bone) {
  const auto found = std::ranges::find_if(
      table.tasks, [&](const ConfigTask& task) { return task.bone == bone && task.has_weight(); });
  return found == table.tasks.end() ? nullptr : &*found;
}

class Doctor {
 public:
  Doctor(const Robot& robot, const RetargetingConfig* config, const UnreadFiles& unread)
      : robot_(robot), config_(config), unread_(unread) {}

  std::vector<RobotFinding> examine();

 private:
  void fault(std::string text) { findings_.push_back({true, std::move(text)}); }
  void note(std::string text) { findings_.push_back({false, std::move(text)}); }

  void check_config();
  void check_offsets();
  [[nodiscard]] std::optional<BoneAxesError> offset_error(const ConfigTask& task) const;
  void check_reach();
  void check_moved_joints();
  void check_sides_of_config();
  void check_sides_of_ranges();
  void check_motion();
  [[nodiscard]] std::string body_name(const ConfigTask& task) const {
    return task.body < 0 ? std::string() : robot_.bodies()[task.body].name;
  }

  const Robot& robot_;
  const RetargetingConfig* config_;
  const UnreadFiles unread_;
  std::optional<ResolvedConfig> resolved_;  // Set if the configuration is valid.
  std::optional<RobotAnatomy> limbs_;
  std::optional<TPose> t_pose_;
  std::vector<RobotFinding> findings_;
};

void Doctor::check_config() {
  if (config_ == nullptr) {
    if (!unread_.config) note("there is no retargeting configuration (ik.json)");
    return;
  }
  auto resolved = resolve_config(*config_, robot_);
  if (resolved) {
    resolved_ = std::move(*resolved);
    return;
  }
  const Error& error = resolved.error();
  if (error.details.empty()) return fault(error.message);
  for (const std::string& detail : error.details) fault(detail);
}

std::optional<BoneAxesError> Doctor::offset_error(const ConfigTask& task) const {
  if (task.body < 0) return std::nullopt;
  // The bone axes identified in the body or, without them, those of the T-pose.
  std::optional<Eigen::Matrix3d> body_from_bone;
  for (const BonePart& part : bone_parts(*limbs_)) {
    if (part.bone == task.bone && part.part.body == task.body) {
      body_from_bone = part.part.body_from_bone;
    }
  }
  if (!body_from_bone) {
    const TreeState posed(robot_.tree(), t_pose_->qpos);
    body_from_bone = posed.world_from_body(task.body).rotation.toRotationMatrix().transpose() *
                     t_pose_of(*limbs_, task.bone);
  }
  const Eigen::Matrix3d given =
      task.rotation_offset.toRotationMatrix().transpose();  // The task's body_from_bone.
  return bone_axes_error(given, *body_from_bone);
}

void Doctor::check_offsets() {
  for (const ConfigTask& task : resolved_->match_tables[0].tasks) {
    if (task.rotation_weight == 0.0) continue;
    const auto error = offset_error(task);
    if (!error || std::max(error->direction, error->twist) < kOddOffset) continue;
    const std::string text =
        "the rotation offset of \"" + body_name(task) + "\" (" + std::string(bone_name(task.bone)) +
        ") leaves it " + degrees_text(error->direction) +
        " degrees off the T-pose in direction and " + degrees_text(error->twist) + " in twist";
    error->direction > kWrongOffset ? fault(text) : note(text);
  }
}

// Checks that the targets of the feet are within the reach of the legs in the T-pose.
void Doctor::check_reach() {
  const TargetBuilder targets(*resolved_, HumanLengths{}.height);
  std::vector<Pose> built(static_cast<std::size_t>(targets.target_count()));
  targets.build(posed_human({}), built);
  const TreeState posed(robot_.tree(), t_pose_->qpos);
  const ConfigTask* root = task_of(resolved_->match_tables[1], resolved_->root_bone);
  if (root == nullptr || root->position_weight == 0.0 || root->body < 0) return;
  const int root_target = targets.target_of(root->bone);
  for (std::size_t side = 0; side < 2; ++side) {
    const Limb& leg = limbs_->legs[side];
    for (const LimbBone foot : {LimbBone::kFootMod, LimbBone::kFoot}) {
      const ConfigTask* task = task_of(resolved_->match_tables[1], side_bone(kSides[side], foot));
      if (task == nullptr || task->position_weight == 0.0) continue;
      const int target = targets.target_of(task->bone);
      if (target < 0 || root_target < 0 || task->body < 0) continue;
      // Distance between hip and ankle with both bodies at their targets.
      const Eigen::Vector3d hip = posed.world_from_body(leg.upper.body) * leg.upper.joint -
                                  posed.world_from_body(root->body).translation +
                                  built[root_target].translation;
      const Eigen::Vector3d ankle = posed.world_from_body(leg.end->body) * leg.end->joint -
                                    posed.world_from_body(task->body).translation +
                                    built[target].translation;
      const double length = leg.upper_length + leg.lower_length;
      const double beyond = (ankle - hip).norm() - length;
      if (beyond < kOddReach * length) continue;
      const std::string text = "in the T-pose the target of \"" + body_name(*task) + "\" is " +
                               number_text(rounded(100.0 * beyond, 1)) +
                               " cm farther from the hip than the leg is long";
      beyond > kWrongReach* length ? fault(text) : note(text);
    }
  }
}

void Doctor::check_moved_joints() {
  std::vector<int> bodies;
  for (const auto& [used, tasks] : resolved_->match_tables) {
    for (const ConfigTask& task : tasks) {
      if (used && task.has_weight()) bodies.push_back(task.body);
    }
  }
  const KinematicTree tree(robot_, bodies);
  const std::vector<int>& written = robot_.output_joints();
  std::vector<std::string> still, left_out;
  for (int joint = 0; joint < static_cast<int>(robot_.joints().size()); ++joint) {
    const bool moves = tree.link_of_joint(joint) != KinematicTree::kWorld;
    const bool is_written = std::ranges::find(written, joint) != written.end();
    if (moves != is_written) (moves ? left_out : still).push_back(robot_.joints()[joint].name);
  }
  if (!still.empty()) note("no task moves " + list_names(still, 8));
  if (!left_out.empty()) {
    note("\"joint_order\" in robot.json leaves out joints that the tasks move, so motions lack " +
         list_names(left_out, 8));
  }
}

void Doctor::check_sides_of_config() {
  for (std::size_t t = 0; t < 2; ++t) {
    for (const ConfigTask& left : resolved_->match_tables[t].tasks) {
      if (side_of(left.bone) != Side::kLeft || !left.has_weight()) continue;
      const std::string bone(bone_name(left.bone)), other(bone_name(mirrored(left.bone)));
      const ConfigTask* right = task_of(resolved_->match_tables[t], mirrored(left.bone));
      const std::string place = fmt::format("{} in table {}", bone, t + 1);
      if (right == nullptr) {
        note(place + " has no counterpart on the right");
        continue;
      }
      if (left.position_weight != right->position_weight ||
          left.rotation_weight != right->rotation_weight) {
        note(fmt::format("weights of {} differ from those of {}", place, other));
      }
      if (t == 0 && resolved_->scales[left.bone] != resolved_->scales[right->bone]) {
        note(fmt::format("the scale of {} differs from that of {}", bone, other));
      }
      const auto error = offset_error(left);
      const auto error_right = offset_error(*right);
      if (t == 0 && error && error_right &&
          std::max(std::abs(error->direction - error_right->direction),
                   std::abs(error->twist - error_right->twist)) > kOddOffset) {
        note(fmt::format("the rotation offset of {} is not the mirror image of that of {}", bone,
                         other));
      }
    }
  }
}

void Doctor::check_sides_of_ranges() {
  constexpr double kSame = 0.01;
  const LimitSet& limits = robot_.model_limits();
  std::vector<std::string> odd;
  for (const auto* pair : {&limbs_->legs, &limbs_->arms}) {
    for (std::size_t i = 0; i < (*pair)[0].joints.size(); ++i) {
      const auto a = static_cast<std::size_t>((*pair)[0].joints[i]);
      const auto b = static_cast<std::size_t>((*pair)[1].joints[i]);
      const auto apart = [&](double lower, double upper) {
        return std::max(std::abs(limits.lower[a] - lower), std::abs(limits.upper[a] - upper));
      };
      const bool unlimited = !std::isfinite(limits.lower[a]) && !std::isfinite(limits.lower[b]);
      if (unlimited || apart(limits.lower[b], limits.upper[b]) < kSame ||
          apart(-limits.upper[b], -limits.lower[b]) < kSame) {
        continue;
      }
      odd.push_back(robot_.joints()[a].name + " / " + robot_.joints()[b].name);
    }
  }
  if (!odd.empty()) note("ranges of left and right are not mirror images: " + list_names(odd, 6));
}

void Doctor::check_motion() {
  const auto test = run_self_test(robot_, *limbs_, *resolved_);
  if (!test) return note("the self-test motion cannot be retargeted: " + test.error().message);
  if (!is_fault(*test)) return note(self_test_text(*test));
  fault(self_test_text(*test) + ": " + self_test_reason(robot_, *limbs_));
}

std::vector<RobotFinding> Doctor::examine() {
  findings_ = model_findings(robot_);
  check_config();
  const auto limbs = find_limbs(robot_, robot_.name());
  if (limbs) {
    limbs_ = *limbs;
    t_pose_ = solve_t_pose(robot_, *limbs);
    for (const std::string& doubt : limbs_->doubts) note(doubt);
    if (const auto cause = t_pose_fault(robot_, *t_pose_)) fault(*cause + "; " + kTPoseHint);
  } else {
    const Error& error = limbs.error();
    fault(error.message + (error.hint.empty() ? "" : "; " + error.hint));
  }
  if (limbs_ && resolved_) {
    check_offsets();
    if (limbs_->has_legs) check_reach();
    check_sides_of_config();
    check_motion();
  }
  if (resolved_ && !unread_.profile) check_moved_joints();
  if (limbs_) check_sides_of_ranges();
  if (!unread_.profile) {
    auto found =
        profile_findings(robot_, limbs_ ? &*limbs_ : nullptr, t_pose_ ? &*t_pose_ : nullptr);
    findings_.insert(findings_.end(), found.begin(), found.end());
  }
  std::ranges::stable_sort(findings_, std::ranges::greater(), &RobotFinding::fault);
  return findings_;
}

std::vector<double> t_pose_of(const Robot& robot) {
  std::vector<double> qpos = reference_configuration(robot);
  for (const auto& [name, position] : robot.profile().t_pose) {
    if (const auto joint = robot.find_joint(name)) {
      qpos[static_cast<std::size_t>(robot.joints()[*joint].qpos_address)] = position;
    }
  }
  return qpos;
}

// The overlaps of all bodies except neighbours in the tree, including those that the profile
// allows.
std::vector<ModelOverlap> overlaps_of(const Robot& robot, const RobotAnatomy& limbs) {
  RobotProfile profile = robot.profile();
  profile.allowed_self_contact = neighbours(robot);
  Robot own(ModelPtr(mj_copyModel(nullptr, robot.model())), std::move(profile));
  own.set_collision_shapes(robot.collision_shapes());
  const std::vector<std::vector<double>> poses = {reference_configuration(robot), t_pose_of(robot)};
  return model_overlaps(own, limbs, poses);
}

}  // namespace

std::vector<RobotFinding> check_robot(const Robot& robot, const RetargetingConfig* config,
                                      const UnreadFiles& unread) {
  return Doctor(robot, config, unread).examine();
}

std::vector<RobotFinding> check_shapes(const Robot& robot, const std::string& model_path) {
  std::vector<RobotFinding> findings;
  const RobotProfile& profile = robot.profile();
  if (profile.soles_estimated && !profile.fixed_base)
    findings.push_back({false, "the soles are " + profile.soles_source});
  if (profile.soles.empty() && !profile.fixed_base) {
    const auto completed = complete_bare_robot(robot, model_path);
    if (!completed) return findings;
    findings.push_back({false, "a run uses the soles " + completed->note});
    if (!completed->overlaps.empty()) {
      findings.push_back({false, kOverlapsIgnored + list_overlaps(completed->overlaps)});
    }
    return findings;
  }
  const auto limbs = find_limbs(robot, model_path);
  if (!limbs) return findings;
  std::vector<std::string> counted, not_counted;
  for (const ModelOverlap& overlap : overlaps_of(robot, *limbs)) {
    const auto& allowed = profile.allowed_self_contact;
    const bool is_allowed = std::ranges::any_of(allowed, [&](const std::pair<int, int>& pair) {
      return pair == std::pair(overlap.a, overlap.b) || pair == std::pair(overlap.b, overlap.a);
    });
    (is_allowed ? not_counted : counted).push_back(overlap_text(robot, overlap));
  }
  if (!counted.empty()) {
    findings.push_back({false,
                        "shapes overlap in the model and count as self-collision; "
                        "\"allowed_self_contact\" in robot.json excludes them: " +
                            list_overlaps(counted)});
  }
  if (!not_counted.empty()) {
    findings.push_back({false, kOverlapsIgnored + list_overlaps(not_counted)});
  }
  return findings;
}

}  // namespace retarget
