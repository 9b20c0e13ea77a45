#include "retarget/pipeline/targets.h"

#include <algorithm>
#include <utility>

namespace retarget {
namespace {

// the row whose offsets count for a bone: table 1 first, in use or not
const IkRow* offsets_of(const IkTables& tables, int bone) {
  for (const IkTable& table : tables.tables) {
    for (const IkRow& row : table.rows) {
      if (row.has_weight() && find_bone(row.bone) == bone) return &row;
    }
  }
  return nullptr;
}

}  // namespace

TargetBuilder::TargetBuilder(const IkTables& tables, double height, HeightScale scale) {
  constexpr double kPublishedHeight = 1.75;
  const double ratio =
      scale == HeightScale::kPublished
          ? height / tables.human_height_assumption
          : kPublishedHeight / tables.human_height_assumption * (kPublishedHeight / height);
  const Eigen::Vector3d ground(0.0, 0.0, tables.ground_height);
  const auto add = [&](const std::string& name) {
    const int bone = find_bone(name).value();
    if (target_of(bone) >= 0) return;
    Rule rule{bone, *tables.find_scale(name) * ratio, -ground, Eigen::Quaterniond::Identity()};
    if (const IkRow* row = offsets_of(tables, bone)) {
      rule.position_offset += row->position_offset;
      rule.bone_from_target = row->rotation_offset;
    }
    rules_.push_back(rule);
  };
  add(tables.human_root);
  for (const IkTable& table : tables.tables) {
    if (!table.used) continue;
    for (const IkRow& row : table.rows) {
      if (row.has_weight()) add(row.bone);
    }
  }
}

std::vector<int> TargetBuilder::bones() const {
  std::vector<int> bones;
  for (const Rule& rule : rules_) bones.push_back(rule.bone);
  return bones;
}

int TargetBuilder::target_of(int bone) const {
  const auto found = std::ranges::find(rules_, bone, &Rule::bone);
  return found == rules_.end() ? -1 : static_cast<int>(found - rules_.begin());
}

void TargetBuilder::build(std::span<const Pose> world_from_bone,
                          std::span<Pose> world_from_target) const {
  const Eigen::Vector3d root = world_from_bone[rules_.front().bone].translation;
  const Eigen::Vector3d scaled_root = rules_.front().scale * root;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    const Rule& rule = rules_[i];
    const Pose& bone = world_from_bone[rule.bone];
    const Eigen::Vector3d scaled =
        i == 0 ? scaled_root
               : Eigen::Vector3d(rule.scale * (bone.translation - root) + scaled_root);
    const Eigen::Quaterniond rotation =
        (bone.rotation.normalized() * rule.bone_from_target).normalized();
    world_from_target[i] = {rotation, scaled + rotation * rule.position_offset};
  }
}

std::shared_ptr<const IkProblem> make_problem(std::shared_ptr<const Robot> robot,
                                              const IkTables& tables, const TargetBuilder& targets,
                                              const LimitSet& limits) {
  auto problem = std::make_shared<IkProblem>();
  for (const IkTable& table : tables.tables) {
    if (!table.used) continue;
    IkPass pass;
    for (const IkRow& row : table.rows) {
      if (!row.has_weight()) continue;
      FrameTask task;
      task.body = robot->find_body(row.body).value();
      task.target = targets.target_of(find_bone(row.bone).value());
      task.position_weight = row.position_weight;
      task.rotation_weight = row.rotation_weight;
      pass.push_back(task);
    }
    problem->passes.push_back(std::move(pass));
  }
  const auto joints = static_cast<Eigen::Index>(robot->joints().size());
  problem->lower = Eigen::Map<const Eigen::VectorXd>(limits.lower.data(), joints);
  problem->upper = Eigen::Map<const Eigen::VectorXd>(limits.upper.data(), joints);
  problem->robot = std::move(robot);
  return problem;
}

}  // namespace retarget
