#include "judge/quality/joint_demand.h"

#include <algorithm>
#include <utility>

#include "retarget/kinematic_tree.h"
#include "retarget/so3.h"

namespace retarget {

JointDemand::JointDemand(const RobotClip& clip, const LimitSet& limits, const QualitySource& source,
                         int frames)
    : clip_(clip),
      human_(source.human),
      frames_(frames),
      spans_(clip.robot().joints().size()),
      posed_(clip.robot().tree()) {
  // TrunkRule::kLines, because the lines of the trunk, not its bones, determine how far a waist
  // should bend. The rule requires limb scaling.
  const auto targets_of = [&](ScaleRule scale) {
    return make_targets(*human_, poses_of(*human_), clip.robot(), *source.config, scale,
                        TrunkRule::kLines, &limits);
  };
  auto targets = targets_of(ScaleRule::kLimbs);
  if (!targets) targets = targets_of(source.scale);
  // Without the bones that the configuration requires, there are no targets.
  if (!targets) return;
  targets_ = std::move(*targets);
  std::vector<Target> turned;
  for (const auto& [used, tasks] : source.config->match_tables) {
    for (const ConfigTask& task : tasks) {
      const int index = targets_->target_of(task.bone);
      const bool is_known = std::ranges::find(turned, task.body, &Target::body) != turned.end();
      if (!used || task.body < 0 || index < 0 || !task.compares_rotation() || is_known) continue;
      turned.push_back({task.body, index});
    }
  }
  find_spans(clip.robot(), turned);
}

void JointDemand::find_spans(const Robot& robot, const std::vector<Target>& targets) {
  const KinematicTree& tree = robot.tree();
  std::vector<std::optional<Target>> on_link(tree.links().size());
  for (const Target& target : targets) on_link[tree.attachment(target.body).link] = target;
  const auto before = [&](int link) {
    std::optional<Target> found;
    for (int above = tree.links()[link].parent; above >= 0 && !found;
         above = tree.links()[above].parent) {
      found = on_link[above];
    }
    return found;
  };
  for (int joint = 0; joint < static_cast<int>(spans_.size()); ++joint) {
    const int first = tree.link_of_joint(joint);
    const auto base = before(first);
    if (!base || tree.links()[first].slides) continue;
    Span span{*base, {}};
    for (int link = first; link <= tree.links()[first].last_descendant; ++link) {
      if (!on_link[link]) continue;
      span.beyond.push_back(*on_link[link]);
      link = tree.links()[link].last_descendant;
    }
    if (!span.beyond.empty()) spans_[joint] = std::move(span);
  }
}

// Solves the trunk at most once per frame, because that takes much longer than the rest.
Eigen::Quaterniond JointDemand::world_from_target(int target) {
  // Radians; a hundredth of the tolerance of reaches().
  constexpr double kPrecise = 2e-4;
  const HumanPose& human = human_->frame(frame_);
  if (!has_trunk_ && targets_->is_of_trunk(target)) {
    trunk_ = targets_->aim_trunk(human, kPrecise);
    has_trunk_ = true;
  }
  return targets_->rotation(target, human, trunk_);
}

bool JointDemand::reaches(int frame, int joint, bool upper) {
  constexpr double kNearly = 0.02;  // Radians; TrunkAim keeps waists farther inside their ranges.
  if (!targets_ || frame >= frames_ || !spans_[joint]) return false;
  if (frame != frame_) {
    frame_ = frame;
    posed_.update(clip_.qpos(frame));
    has_trunk_ = false;
  }
  const auto& [before, beyond] = *spans_[joint];
  const Eigen::Quaterniond robot_from_target =
      posed_.world_from_body(before.body).rotation * world_from_target(before.index).conjugate();
  double demand = 0.0;
  for (const Target& target : beyond) {
    const Eigen::Quaterniond wanted = robot_from_target * world_from_target(target.index);
    const Eigen::Quaterniond away =
        wanted * posed_.world_from_body(target.body).rotation.conjugate();
    demand += log_so3(away).dot(posed_.axis(joint)) / static_cast<double>(beyond.size());
  }
  return (upper ? demand : -demand) > -kNearly;
}

}  // namespace retarget
