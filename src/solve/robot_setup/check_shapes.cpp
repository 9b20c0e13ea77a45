#include "solve/robot_setup/check_shapes.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <utility>

#include "robot/anatomy/bare_robot.h"
#include "robot/anatomy/branches.h"
#include "robot/anatomy/limbs.h"
#include "robot/anatomy/overlaps.h"

namespace retarget {
namespace {

std::vector<double> t_pose_of(const Robot& robot) {
  std::vector<double> qpos = reference_configuration(robot);
  for (const auto& [name, position] : robot.profile().t_pose) {
    if (const auto joint = robot.find_joint(name)) {
      qpos[static_cast<std::size_t>(robot.joints()[*joint].qpos_address)] = position;
    }
  }
  return qpos;
}

// Returns the overlaps of all bodies except neighbours, including those that the profile allows.
std::vector<ModelOverlap> overlaps_of(const Robot& robot, const RobotAnatomy& limbs) {
  RobotProfile profile = robot.profile();
  profile.allowed_self_contact = neighbours(robot);
  Robot own(ModelPtr(mj_copyModel(nullptr, robot.model())), std::move(profile));
  own.set_collision_shapes(robot.collision_shapes());
  const std::vector<std::vector<double>> poses = {reference_configuration(robot), t_pose_of(robot)};
  return model_overlaps(own, limbs, poses);
}

std::string list(const std::vector<std::string>& texts) {
  constexpr std::size_t kMost = 8;
  if (texts.size() <= kMost) return fmt::format("{}", fmt::join(texts, "; "));
  const std::vector<std::string> first(texts.begin(), texts.begin() + kMost);
  return fmt::format("{}; and {} more", fmt::join(first, "; "), texts.size() - kMost);
}

constexpr const char* kNotCounted =
    "their shapes overlap in the model, so their contact is ignored: ";

}  // namespace

std::vector<RobotFinding> check_shapes(const Robot& robot, const std::string& model_path) {
  std::vector<RobotFinding> findings;
  const RobotProfile& profile = robot.profile();
  if (profile.soles_estimated && !profile.fixed_base)
    findings.push_back({false, "the soles are " + profile.soles_source});
  if (profile.soles.empty() && !profile.fixed_base) {
    const auto completed = complete_bare_robot(robot, model_path);
    if (!completed) return findings;
    findings.push_back({false, "a run uses the soles from " + completed->note});
    if (!completed->overlaps.empty()) {
      findings.push_back({false, kNotCounted + list(completed->overlaps)});
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
                            list(counted)});
  }
  if (!not_counted.empty()) findings.push_back({false, kNotCounted + list(not_counted)});
  return findings;
}

}  // namespace retarget
