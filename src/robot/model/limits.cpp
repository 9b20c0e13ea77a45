#include "robot/model/limits.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/json.h"
#include "base/try.h"
#include "retarget/text.h"
#include "robot/model/load_model.h"
#include "robot/model/variant.h"

namespace retarget {
namespace {

bool is_range(const nlohmann::ordered_json& json) {
  return json.is_array() && json.size() == 2 && json[0].is_number() && json[1].is_number() &&
         std::isfinite(json[0].get<double>()) && std::isfinite(json[1].get<double>());
}

bool is_limited(const LimitSet& set, std::size_t joint) {
  return std::isfinite(set.lower[joint]) && std::isfinite(set.upper[joint]);
}

// Describes ranges that look like degrees; empty if there are none. A set may give wide ranges to
// single joints that the model does not limit, such as wheels.
std::string degrees_text_of(const LimitSet& set, const Robot& robot) {
  constexpr std::size_t kEnough = 6;
  std::vector<std::string> wide;
  std::size_t limited = 0;
  double widest = 0.0;
  bool contradicts_model = false;
  for (std::size_t j = 0; j < robot.joints().size(); ++j) {
    if (robot.joints()[j].type != RobotJoint::Type::kHinge || !is_limited(set, j)) continue;
    ++limited;
    const bool is_wide =
        looks_like_degrees(robot, j, set.lower[j]) || looks_like_degrees(robot, j, set.upper[j]);
    if (!is_wide) continue;
    wide.push_back("\"" + robot.joints()[j].name + "\"");
    widest = std::max({widest, std::abs(set.lower[j]), std::abs(set.upper[j])});
    contradicts_model = contradicts_model || is_limited(robot.model_limits(), j);
  }
  const bool most = wide.size() >= kEnough && 2 * wide.size() > limited;
  if (!contradicts_model && !most) return {};
  return fmt::format("ranges reach {} rad, which looks like degrees: {}; write them in radians",
                     number_text(widest, 0), list_names(wide, 6));
}

}  // namespace

bool looks_like_degrees(const Robot& robot, std::size_t joint, double position) {
  if (robot.joints()[joint].type != RobotJoint::Type::kHinge) return false;
  const LimitSet& own = robot.model_limits();
  const bool in_range =
      is_limited(own, joint) && position >= own.lower[joint] && position <= own.upper[joint];
  return std::abs(position) > kLikeDegrees && !in_range;
}

LimitSet ranges_from_json(const nlohmann::ordered_json& json, const Robot& robot,
                          const std::string& what, Faults& faults) {
  LimitSet set = robot.model_limits();
  if (!json.is_object()) {
    faults.add(what + " must be an object of [lower, upper] by joint");
    return set;
  }
  for (const auto& [name, range] : json.items()) {
    const auto joint = robot.find_joint(name);
    // A variant's own model lacks its locked joints.
    if (!joint && robot.variant().locked.contains(name)) continue;
    if (!joint) {
      faults.add(fmt::format("{}: the model has no joint \"{}\"{}", what, name,
                             faults.suggestion(name, robot.joint_names())));
    } else if (!is_range(range)) {
      faults.add(fmt::format("{} of \"{}\" must be [lower, upper], found {}", what, name,
                             short_text(range)));
    } else if (range[0].get<double>() > range[1].get<double>()) {
      faults.add(
          fmt::format("{} of \"{}\": lower is above upper in {}", what, name, short_text(range)));
    } else {
      set.lower[*joint] = range[0].get<double>();
      set.upper[*joint] = range[1].get<double>();
    }
  }
  const std::string degrees = degrees_text_of(set, robot);
  if (!degrees.empty()) faults.add(what + ": " + degrees);
  return set;
}

namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// Copies joint ranges from another model of the robot, matched by joint name. That model need not
// be a complete robot.
Result<LimitSet> limits_from_model(const Robot& robot, const std::string& path) {
  TRY_ASSIGN(const auto other, load_model(path));
  const mjModel& model = *other.model;
  LimitSet set = robot.model_limits();
  std::vector<std::string> other_names;
  bool common = false;
  for (int j = 0; j < model.njnt; ++j) {
    const char* name = mj_id2name(&model, mjOBJ_JOINT, j);
    if (name == nullptr) continue;
    other_names.emplace_back(name);
    const auto joint = robot.find_joint(name);
    if (!joint) continue;
    common = true;
    const bool limited = model.jnt_limited[j] != 0;
    set.lower[*joint] = limited ? model.jnt_range[2 * j] : -kNoLimit;
    set.upper[*joint] = limited ? model.jnt_range[2 * j + 1] : kNoLimit;
  }
  if (!common) {
    return config_failure(path, "the model has none of the joints in " + robot.name(),
                          "its joints are " + list_names(other_names));
  }
  const std::string degrees = degrees_text_of(set, robot);
  if (!degrees.empty()) return config_failure(path, degrees);
  return set;
}

Result<LimitSet> limits_from_json(const Robot& robot, const std::string& path) {
  TRY_ASSIGN(const auto json, load_json(path));
  Faults faults;
  LimitSet set = ranges_from_json(json, robot, "the joint limits", faults);
  if (!faults.empty()) return faults.failure_in(path, "the joint limits");
  return set;
}

}  // namespace

Result<LimitSet> load_limits(const Robot& robot, const std::string& name_or_file) {
  std::vector<std::string> names = {robot.model_limits().name};
  if (name_or_file == robot.model_limits().name) return robot.model_limits();
  for (const LimitSet& set : robot.profile().limit_sets) {
    if (set.name == name_or_file) return set;
    names.push_back(set.name);
  }
  const bool is_xml = name_or_file.ends_with(".xml");
  if (!is_xml && !name_or_file.ends_with(".json")) {
    return config_failure(
        "",
        "the robot " + robot.name() + " has no limit set \"" + name_or_file + "\"" +
            did_you_mean(name_or_file, names),
        "its sets are " + list_names(names) + "; a file must end in .json or .xml");
  }
  TRY_ASSIGN(auto set, is_xml ? limits_from_model(robot, name_or_file)
                              : limits_from_json(robot, name_or_file));
  set.name = name_or_file;
  set.source = name_or_file;
  hold_locked_joints(robot, set);
  return set;
}

namespace {

// Marks the joints that leave the zero configuration in at least one frame.
std::vector<bool> moving_joints(const RobotClip& clip) {
  const std::vector<double> zero = clip.robot().zero_configuration();
  std::vector<bool> moves;
  for (const RobotJoint& joint : clip.robot().joints()) {
    bool any = false;
    for (int frame = 0; frame < clip.frame_count() && !any; ++frame) {
      any = clip.qpos(frame)[joint.qpos_address] != zero[joint.qpos_address];
    }
    moves.push_back(any);
  }
  return moves;
}

}  // namespace

std::optional<LimitDistance> nearest_limit(const RobotClip& clip, const LimitSet& limits) {
  LimitDistance nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  const std::vector<bool> moves = moving_joints(clip);
  int frames_at_limit = 0;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    bool at_limit = false;
    for (std::size_t j = 0; j < clip.robot().joints().size(); ++j) {
      if (!moves[j] || limits.lower[j] == limits.upper[j]) continue;
      const RobotJoint& joint = clip.robot().joints()[j];
      const double q = clip.qpos(frame)[joint.qpos_address];
      const double from_lower = q - limits.lower[j];
      const double from_upper = limits.upper[j] - q;
      const double distance = std::min(from_lower, from_upper);
      at_limit = at_limit || distance <= kAtLimit;
      if (distance < nearest.distance) {
        nearest.joint = joint.name;
        nearest.frame = frame;
        nearest.at_upper = from_upper < from_lower;
        nearest.distance = distance;
      }
    }
    if (at_limit) ++frames_at_limit;
  }
  if (nearest.joint.empty()) return std::nullopt;
  nearest.frames_at_limit = static_cast<double>(frames_at_limit) / clip.frame_count();
  return nearest;
}

}  // namespace retarget
