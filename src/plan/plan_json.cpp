// A plan as JSON: what was decided, so that it may be looked at, changed and solved again.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "base/faults.h"
#include "base/json_members.h"
#include "base/try.h"
#include "base/utf8.h"
#include "human/limb_directions.h"
#include "human/robot_human.h"
#include "options/enum_names.h"
#include "options/fit_options.h"
#include "options/options_json.h"
#include "options/run_tables.h"
#include "plan/memory.h"
#include "plan/unknown_rotations.h"
#include "retarget/plan.h"
#include "retarget/version.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

template <typename Vector>
Json numbers(const Vector& values) {
  return Json(std::vector<double>(values.data(), values.data() + values.size()));
}

// of no bounds, which JSON has no number for, null
Json bound_json(double bound) {
  return std::isfinite(bound) ? Json(bound) : Json();
}

Json bones_json(const Plan& plan) {
  Json json = Json::object();
  const Skeleton& skeleton = plan.clip->skeleton();
  const auto joint_json = [&](int joint) {
    return joint < 0 ? Json() : Json(valid_utf8(skeleton.joint(joint).name));
  };
  for (const Bone bone : kAllBones) {
    const BoneSource& source = plan.human.calibration.bones[bone];
    if (source.position_joint < 0 && plan.human.map.joint(bone) < 0) continue;
    Json& row = json[std::string(bone_name(bone))];
    // the number counts, the name is for people and held against it
    row["joint"] = plan.human.map.joint(bone);
    row["position_joint"] = source.position_joint;
    row["rotation_joint"] = source.rotation_joint;
    row["position_joint_name"] = joint_json(source.position_joint);
    if (source.joint_from_bone)
      row["joint_from_bone_xyzw"] = numbers(source.joint_from_bone->coeffs());
    if (source.position_in_joint) row["position_in_joint"] = numbers(*source.position_in_joint);
  }
  return json;
}

// all that a plan says of a human but for the bones, by its key
template <typename Human, typename Visit>
void visit_human(Human& human, const Visit& visit) {
  auto& [map, calibration] = human;
  visit("description", calibration.description);
  visit("dialect", calibration.profile);
  visit("recognised_by", map.profile);
  visit("confidence", map.confidence);
  visit("partial", map.partial);
  visit("unit", calibration.unit);
  visit("metres_per_unit", calibration.metres_per_unit);
  visit("up", calibration.up);
  visit("forward", calibration.forward);
  visit("rest_pose", calibration.rest_pose);
  visit("rest_deviation_deg", calibration.rest_deviation);
  visit("height", calibration.height);
  visit("size", calibration.size);
  visit("human_from_source", calibration.human_from_source);
}

template <typename Value>
Json value_json(const Value& value) {
  return value;
}
Json value_json(const SignedAxis& axis) {
  return to_text(axis);
}
Json value_json(const Eigen::Matrix3d& matrix) {
  return numbers(matrix);
}

Json human_json(const Plan& plan) {
  Json json;
  visit_human(plan.human,
              [&](const char* key, const auto& value) { json[key] = value_json(value); });
  json["bones"] = bones_json(plan);
  return json;
}

// reads members, each of which must be there; faults are collected
class Reader {
 public:
  Reader(const Json& json, Faults& faults) : json_(json), faults_(faults) {}

  template <typename Value>
  void take(const char* key, Value& value) {
    const auto found = json_.find(key);
    if (found == json_.end()) return fault(key, "is missing");
    if (auto known = value_from<Value>(*found)) {
      value = *std::move(known);
    } else {
      fault(key, "has the wrong type");
    }
  }
  // as many numbers as there are
  template <typename Number>
  void take_list(const char* key, std::span<Number> numbers) {
    std::vector<Number> values;
    take(key, values);
    if (values.size() != numbers.size()) {
      return fault(key, fmt::format("does not have {} numbers", numbers.size()));
    }
    std::ranges::copy(values, numbers.begin());
  }
  template <typename Vector>
  void take_numbers(const char* key, Vector&& vector) {
    take_list(key, std::span(vector.data(), static_cast<std::size_t>(vector.size())));
  }
  void take(const char* key, SignedAxis& axis) {
    std::string text;
    take(key, text);
    const bool sound = text.size() == 2 && text[1] >= 'x' && text[1] <= 'z';
    if (!sound) return fault(key, "is not an axis");
    axis = {text[1] - 'x', text[0] == '-'};
  }
  void take(const char* key, Eigen::Matrix3d& matrix) { take_numbers(key, matrix); }
  void take_joint(const char* key, int joints, int& joint) {
    take(key, joint);
    if (joint < -1 || joint >= joints) fault(key, "is not a joint of the clip");
  }
  void fault(const char* key, const std::string& what) {
    faults_.add(fmt::format("\"{}\" {}", key, what));
  }
  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }

 private:
  const Json& json_;
  Faults& faults_;
};

const Json& member(const Json& json, const char* key) {
  static const Json kNone = Json::object();
  const auto found = json.find(key);
  return found != json.end() && found->is_object() ? *found : kNone;
}

void read_bones(const Json& json, const Skeleton& skeleton, HumanInClip& human, Faults& faults) {
  for (const auto& [name, row] : json.items()) {
    const auto bone = bone_from_name(name);
    if (bone && !row.is_object()) {
      faults.add(fmt::format("\"{}\" must be an object, found {}", name, short_text(row)));
      continue;
    }
    if (!bone) {
      faults.add(
          fmt::format("there is no bone \"{}\"{}", name, faults.suggestion(name, bone_names())));
      continue;
    }
    Reader reader(row, faults);
    BoneSource& source = human.calibration.bones[*bone];
    reader.take_joint("joint", skeleton.joint_count(), human.map.joint_of_bone[*bone]);
    reader.take_joint("position_joint", skeleton.joint_count(), source.position_joint);
    reader.take_joint("rotation_joint", skeleton.joint_count(), source.rotation_joint);
    if (reader.has("joint_from_bone_xyzw")) {
      reader.take_numbers("joint_from_bone_xyzw", source.joint_from_bone.emplace().coeffs());
    }
    if (reader.has("position_in_joint")) {
      reader.take_numbers("position_in_joint", source.position_in_joint.emplace());
    }
    if (source.position_joint < 0 || source.position_joint >= skeleton.joint_count()) continue;
    const std::string joint = valid_utf8(skeleton.joint(source.position_joint).name);
    if (row.value("position_joint_name", Json(joint)) != Json(joint)) {
      faults.add(fmt::format("\"{}\": the clip's joint there is \"{}\"", name, joint));
    }
  }
}

void read_human(const Json& json, Plan& plan, const Skeleton& skeleton, Faults& faults) {
  Reader reader(json, faults);
  visit_human(plan.human, [&](const char* key, auto& value) { reader.take(key, value); });
  read_bones(member(json, "bones"), skeleton, plan.human, faults);
}

void read_limits(const Json& json, const Robot& robot, LimitSet& limits, Faults& faults) {
  Reader(json, faults).take("name", limits.name);
  const Json& ranges = member(json, "ranges");
  for (std::size_t i = 0; i < robot.joints().size(); ++i) {
    const std::string& name = robot.joints()[i].name;
    const auto range = ranges.find(name);
    if (range == ranges.end() || !range->is_array() || range->size() != 2) {
      faults.add("limits: no range for the joint \"" + name + "\"");
      continue;
    }
    const auto bound = [&](const Json& value, double none) {
      return value.is_number() ? value.get<double>() : none;
    };
    limits.lower[i] = bound((*range)[0], -HUGE_VAL);
    limits.upper[i] = bound((*range)[1], HUGE_VAL);
    if (!(limits.lower[i] <= limits.upper[i])) {
      faults.add("limits: the range of \"" + name + "\" is reversed");
    }
  }
}

void read_decisions(const Json& json, Plan& plan, Faults& faults) {
  Reader reader(json, faults);
  std::array<int, 2> part{};
  reader.take_list("part", std::span<int>(part));
  plan.part = {part[0], part[1]};
  const bool inside = 0 <= part[0] && part[0] < part[1] && part[1] <= plan.clip->frame_count();
  if (!inside) reader.fault("part", "is not a part of the clip");
  reader.take("lead_in_frames", plan.lead_in_frames);
  std::array<std::int64_t, 2> rate{};
  reader.take_list("rate", std::span<std::int64_t>(rate));
  plan.rate = {rate[0], rate[1]};
  const bool sound =
      rate[0] > 0 && rate[1] > 0 && plan.rate == frame_rate_from_fps(plan.rate.fps());
  if (!sound) reader.fault("rate", "is not a rate in lowest terms");
  std::string scale;
  reader.take("scale", scale);
  const auto known = enum_from_name<ScaleRule>(scale);
  if (!known) return reader.fault("scale", "is not table, height or limbs");
  plan.scale = *known;
}

}  // namespace

std::string plan_json(const Plan& plan) {
  Json json;
  json["retarget"] = version_number();
  Run run;
  run.motion = plan.clip->name();
  run.robot = plan.robot.choice;
  run.options = plan.options;
  json["run"] = options_json(run_table(run));
  json["human"] = human_json(plan);
  json["part"] = {plan.part.begin, plan.part.end};
  json["lead_in_frames"] = plan.lead_in_frames;
  json["rate"] = {plan.rate.frames, plan.rate.seconds};
  json["scale"] = enum_name(plan.scale);
  put_name(json, "mapping", plan.config.file);
  Json& limits = json["limits"];
  limits["name"] = plan.limits.name;
  const auto& joints = plan.robot.robot->joints();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    limits["ranges"][joints[i].name] = {bound_json(plan.limits.lower[i]),
                                        bound_json(plan.limits.upper[i])};
  }
  FitOptions fit = plan.fit;
  json["fit"] = options_json(fit_table(fit));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<Plan> load_plan(const std::string& file, const DataFolder& data_folder) {
  TRY_ASSIGN(const Json json, load_json(file));
  if (!json.is_object()) return config_failure(file, "the file is not a plan");
  Plan plan;
  Run run;
  TRY(read_options(member(json, "run"), run_table(run), file, "the plan's run"));
  plan.options = run.options;
  TRY_ASSIGN(plan.robot, load_robot(run.robot, data_folder));
  TRY_ASSIGN(Clip clip, load_clip(run.motion, run.options.source, data_folder));
  Faults faults;
  read_human(member(json, "human"), plan, clip.skeleton(), faults);
  if (!faults.empty()) return faults.failure_in(file, "the plan");
  // positions that rotations do not carry: as the plan's own clip was mended
  BoneMap map = plan.human.map;
  if (is_of_robot(clip)) {
    const Calibration own = calibration_of_robot(clip, map);
    plan.human.calibration.soles = own.soles;
    plan.human.calibration.built = own.built;
  } else {
    static_cast<void>(let_directions_win(clip, map));
  }
  plan.clip = std::make_shared<const Clip>(std::move(clip));
  read_decisions(json, plan, faults);
  plan.limits = plan.robot.robot->model_limits();
  read_limits(member(json, "limits"), *plan.robot.robot, plan.limits, faults);
  const std::string config_file = name_from(json, "mapping");
  if (config_file.empty()) faults.add("\"mapping\" is missing");
  if (!faults.empty()) return faults.failure_in(file, "the plan");
  TRY(read_options(member(json, "fit"), fit_table(plan.fit), file, "the plan's fit"));
  TRY(check_need({plan.frame_count(), plan.rate, plan.clip->origin().bytes, plan.clip->name()},
                 plan.options.source.memory_gb, plan.options.save));
  TRY_ASSIGN(plan.config, load_config(config_file, *plan.robot.robot));
  if (plan.human.map.partial) TRY(leave_out_bones(plan.config, plan.human.missing_bones()));
  leave_out_unknown_rotations(*plan.clip, plan);
  return plan;
}

}  // namespace retarget
