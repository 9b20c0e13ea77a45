#include "retarget/retargeting_config.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/faults.h"
#include "base/json.h"
#include "base/try.h"
#include "retarget/file.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnitTolerance = 1e-3;
constexpr const char* kNoTask = "no row of a used table has a weight, so no body would move";

std::string table_key(std::size_t table) {
  return "ik_match_table" + std::to_string(table + 1);
}

// Reads a retargeting configuration and collects all errors.
class ConfigReader {
 public:
  ConfigReader(const Json& json, Faults& faults) : json_(json), faults_(faults) {}

  RetargetingConfig read(const std::string& file) {
    RetargetingConfig config;
    config.file = file;
    config.robot_root = text("robot_root_name");
    config.human_root = text("human_root_name");
    config.ground_height = number("ground_height");
    config.human_height_assumption = number("human_height_assumption");
    if (config.human_height_assumption <= 0.0 && json_.contains("human_height_assumption")) {
      faults_.add("\"human_height_assumption\" must be more than 0");
    }
    if (const Json* scales = find("human_scale_table")) {
      if (!scales->is_object()) faults_.add("\"human_scale_table\" must be an object of numbers");
      for (const auto& [bone, scale] : scales->items()) {
        const std::string what = "scale of \"" + bone + "\"";
        config.scales.emplace_back(bone, number(scale, what));
        if (is_number(scale) && scale <= 0.0) faults_.add(what + " must be more than 0");
      }
    }
    for (std::size_t table = 0; table < 2; ++table) {
      config.match_tables[table] = read_table(table_key(table));
    }
    return config;
  }

 private:
  const Json* find(const std::string& key) {
    const auto found = json_.find(key);
    if (found != json_.end()) return &*found;
    faults_.add(fmt::format("\"{}\" is missing", key));
    return nullptr;
  }

  std::string text(const std::string& key) {
    const Json* value = find(key);
    if (value == nullptr) return {};
    if (value->is_string()) return value->get<std::string>();
    faults_.add(fmt::format("\"{}\" must be a string, found {}", key, value->dump()));
    return {};
  }

  double number(const std::string& key) {
    const Json* value = find(key);
    return value == nullptr ? 0.0 : number(*value, "\"" + key + "\"");
  }
  double number(const Json& value, const std::string& what) {
    if (is_number(value)) return value.get<double>();
    faults_.add(fmt::format("{} must be a number, found {}", what, value.dump()));
    return 0.0;
  }
  static bool is_number(const Json& value) {
    return value.is_number() && std::isfinite(value.get<double>());
  }

  // A missing key means that the table is used.
  bool is_used(const std::string& key) {
    const auto found = json_.find(key);
    if (found == json_.end()) return true;
    if (found->is_boolean()) return found->get<bool>();
    faults_.add(fmt::format("\"{}\" must be true or false, found {}", key, found->dump()));
    return true;
  }

  template <int kSize>
  std::optional<Eigen::Matrix<double, kSize, 1>> vector(const Json& value,
                                                        const std::string& what) {
    if (!value.is_array() || value.size() != kSize ||
        !std::all_of(value.begin(), value.end(), is_number)) {
      faults_.add(fmt::format("{} must be {} numbers, found {}", what, kSize, value.dump()));
      return std::nullopt;
    }
    Eigen::Matrix<double, kSize, 1> result;
    for (int i = 0; i < kSize; ++i) result[i] = value[i].template get<double>();
    return result;
  }

  IkMatch read_row(const std::string& what, const std::string& body, const Json& json) {
    IkMatch row;
    row.body = body;
    if (!json.is_array() || json.size() != 5 || !json[0].is_string()) {
      faults_.add(
          fmt::format("{} must be [bone, position weight, rotation weight, position "
                      "offset, rotation offset], found {}",
                      what, json.dump()));
      return row;
    }
    row.bone = json[0].get<std::string>();
    row.position_weight = number(json[1], "position weight in " + what);
    row.rotation_weight = number(json[2], "rotation weight in " + what);
    if (row.position_weight < 0.0 || row.rotation_weight < 0.0) {
      faults_.add("a weight in " + what + " is negative");
    }
    row.position_offset =
        vector<3>(json[3], "position offset in " + what).value_or(row.position_offset);
    const auto wxyz = vector<4>(json[4], "rotation offset in " + what);
    if (!wxyz) return row;
    const double norm = wxyz->norm();
    if (std::abs(norm - 1.0) > kUnitTolerance) {
      faults_.add(fmt::format(
          "rotation offset in {} is not a unit quaternion (w, x, y, z): its norm is {:f}", what,
          norm));
      return row;
    }
    const Eigen::Vector4d unit = *wxyz / norm;
    row.rotation_offset = Eigen::Quaterniond(unit[0], unit[1], unit[2], unit[3]);
    return row;
  }

  IkMatchTable read_table(const std::string& key) {
    IkMatchTable table;
    table.used = is_used("use_" + key);
    const Json* json = find(key);
    if (json == nullptr) return table;
    if (!json->is_object()) {
      faults_.add("\"" + key + "\" must be an object of rows by robot body");
      return table;
    }
    for (const auto& [body, row] : json->items()) {
      table.rows.push_back(read_row(fmt::format("{} of \"{}\"", key, body), body, row));
    }
    return table;
  }

  const Json& json_;
  Faults& faults_;
};

bool has_task(const ResolvedConfig& resolved) {
  return std::ranges::any_of(resolved.match_tables, [](const ResolvedConfig::Table& table) {
    return table.used && std::ranges::any_of(table.tasks, &ConfigTask::has_weight);
  });
}

// The human bodies that a configuration names, without repetitions, the root first.
std::vector<std::string> named_human_bodies(const RetargetingConfig& config) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  add(config.human_root);
  for (const IkMatchTable& table : config.match_tables) {
    for (const IkMatch& row : table.rows) add(row.bone);
  }
  return names;
}

// Resolves the names of a retargeting configuration for a robot.
class Resolver {
 public:
  Resolver(const RetargetingConfig& config, const Robot& robot, Faults& faults)
      : config_(config), robot_(robot), bodies_(robot.body_names()), faults_(faults) {}
  // @param human_bodies  names that replace those of the bones: body i has the index of bone i. At
  //     most kBoneCount.
  Resolver(const RetargetingConfig& config, const Robot& robot, Faults& faults,
           const std::vector<std::string>& human_bodies)
      : Resolver(config, robot, faults) {
    human_bodies_ = &human_bodies;
  }

  ResolvedConfig resolve() {
    resolved_.file = config_.file;
    resolved_.ground_height = config_.ground_height;
    resolved_.human_height_assumption = config_.human_height_assumption;
    for (const auto& [name, scale] : config_.scales) {
      const auto bone = find_bone(name);
      if (!bone || has_scale_[*bone]) continue;
      resolved_.scales[*bone] = scale;
      has_scale_[*bone] = true;
    }
    resolve_roots();
    for (std::size_t number = 0; number < 2; ++number) resolve_table(number);
    if (!has_task(resolved_) && faults_.empty()) faults_.add(kNoTask);
    return std::move(resolved_);
  }

 private:
  [[nodiscard]] std::optional<Bone> find_bone(std::string_view name) const {
    if (human_bodies_ == nullptr) return bone_from_name(name);
    const auto found = std::ranges::find(*human_bodies_, name);
    if (found == human_bodies_->end()) return std::nullopt;
    return static_cast<Bone>(found - human_bodies_->begin());
  }
  [[nodiscard]] const std::vector<std::string>& known_bones() const {
    return human_bodies_ == nullptr ? bone_names() : *human_bodies_;
  }

  void resolve_roots() {
    const auto body = robot_.find_body(config_.robot_root);
    resolved_.root_body = body.value_or(0);
    if (!body && !config_.robot_root.empty()) {
      faults_.add(fmt::format("\"robot_root_name\": the robot has no body \"{}\"{}",
                              config_.robot_root, did_you_mean(config_.robot_root, bodies_)));
    }
    const auto bone = find_bone(config_.human_root);
    resolved_.root_bone = bone.value_or(Bone::kHips);
    if (config_.human_root.empty()) return;
    if (!bone) {
      faults_.add(fmt::format("\"human_root_name\": no bone \"{}\"{}", config_.human_root,
                              did_you_mean(config_.human_root, known_bones())));
    } else if (!has_scale_[*bone]) {
      faults_.add(fmt::format("the root bone \"{}\" has no entry in \"human_scale_table\"",
                              config_.human_root));
    }
  }

  void resolve_table(std::size_t number) {
    const IkMatchTable& table = config_.match_tables[number];
    resolved_.match_tables[number].used = table.used;
    std::map<std::string, std::string> body_of_bone;
    for (const IkMatch& row : table.rows) {
      const auto body = robot_.find_body(row.body);
      const auto bone = find_bone(row.bone);
      if (bone) {
        resolved_.match_tables[number].tasks.push_back(
            {static_cast<const IkTask&>(row), body.value_or(-1), *bone});
      }
      if (!table.used) continue;
      check_row(row, table_key(number), body.has_value(), bone);
      if (!row.has_weight()) continue;
      const auto [found, is_new] = body_of_bone.try_emplace(row.bone, row.body);
      if (!is_new) {
        faults_.add(fmt::format("{}: the bone \"{}\" drives two bodies, \"{}\" and \"{}\"",
                                table_key(number), row.bone, found->second, row.body));
      }
    }
  }

  void check_row(const IkMatch& row, const std::string& table, bool has_body,
                 std::optional<Bone> bone) {
    if (!has_body) {
      faults_.add(fmt::format("{}: the robot has no body \"{}\"{}", table, row.body,
                              faults_.suggestion(row.body, bodies_)));
    }
    if (row.bone.empty()) return;  // The reader has already reported this row.
    if (!bone) {
      faults_.add(fmt::format("{} of \"{}\": no bone \"{}\"{}", table, row.body, row.bone,
                              faults_.suggestion(row.bone, known_bones())));
    } else if (!has_scale_[*bone]) {
      faults_.add(fmt::format("{} of \"{}\": the bone \"{}\" has no entry in \"human_scale_table\"",
                              table, row.body, row.bone));
    }
  }

  const RetargetingConfig& config_;
  const Robot& robot_;
  const std::vector<std::string> bodies_;
  Faults& faults_;
  const std::vector<std::string>* human_bodies_ = nullptr;
  BoneArray<bool> has_scale_;
  ResolvedConfig resolved_;
};

// Parses a retargeting configuration and calls `use`, which may add errors to those of the parser.
template <typename Use>
auto read_text(std::string_view text, const std::string& file, const Use& use)
    -> Result<decltype(use(RetargetingConfig(), std::declval<Faults&>()))> {
  TRY_ASSIGN(const auto json, parse_json(text, file));
  if (!json.is_object())
    return config_failure(file, "a retargeting configuration must be a JSON object");
  Faults faults;
  auto result = use(ConfigReader(json, faults).read(file), faults);
  if (!faults.empty()) return faults.failure_in(file, "the retargeting configuration");
  return result;
}

}  // namespace

const double* RetargetingConfig::find_scale(std::string_view bone) const {
  const auto found = std::ranges::find(scales, bone, &std::pair<std::string, double>::first);
  return found == scales.end() ? nullptr : &found->second;
}

Result<RetargetingConfig> parse_retargeting_config(std::string_view text, const std::string& file) {
  return read_text(text, file, [](RetargetingConfig config, Faults&) { return config; });
}

Result<RetargetingConfig> load_retargeting_config(const std::string& path) {
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig, kMaxTextBytes));
  return parse_retargeting_config(text.view(), path);
}

Result<ResolvedConfig> resolve_config(const RetargetingConfig& config, const Robot& robot) {
  Faults faults;
  auto resolved = Resolver(config, robot, faults).resolve();
  if (!faults.empty()) return faults.failure_in(config.file, "the retargeting configuration");
  return resolved;
}

Result<HumanConfig> resolve_human_config(const RetargetingConfig& config, const Robot& robot) {
  HumanConfig human;
  human.bodies = named_human_bodies(config);
  if (human.bodies.size() > kBoneCount) {
    return config_failure(config.file,
                          fmt::format("the tables name {} bodies of the human, more than {}",
                                      human.bodies.size(), kBoneCount));
  }
  Faults faults;
  human.tables = Resolver(config, robot, faults, human.bodies).resolve();
  if (!faults.empty()) return faults.failure_in(config.file, "the retargeting configuration");
  return human;
}

Result<ResolvedConfig> load_config(const std::string& path, const Robot& robot) {
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig, kMaxTextBytes));
  return read_text(text.view(), path, [&](const RetargetingConfig& config, Faults& faults) {
    return Resolver(config, robot, faults).resolve();
  });
}

const ConfigTask* ResolvedConfig::find_task(Bone bone) const {
  const ConfigTask* found = nullptr;
  for (const Table& table : match_tables) {
    for (const ConfigTask& task : table.tasks) {
      if (task.bone != bone) continue;
      if (task.has_weight()) return &task;
      if (found == nullptr) found = &task;
    }
  }
  return found;
}

int ResolvedConfig::body_of(Bone bone) const {
  const ConfigTask* const task = find_task(bone);
  return task == nullptr ? -1 : task->body;
}

Result<int> leave_out_bones(ResolvedConfig& resolved, std::span<const Bone> bones) {
  std::size_t dropped = 0;
  for (auto& table : resolved.match_tables) {
    dropped += std::erase_if(table.tasks, [&](const ConfigTask& task) {
      return std::ranges::find(bones, task.bone) != bones.end();
    });
  }
  if (!has_task(resolved)) return config_failure(resolved.file, kNoTask);
  return static_cast<int>(dropped);
}

}  // namespace retarget
