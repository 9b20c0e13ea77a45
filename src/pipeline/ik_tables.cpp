#include "retarget/ik_config.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/faults.h"
#include "base/file.h"
#include "base/json.h"
#include "base/suggest.h"
#include "base/text_size.h"
#include "base/try.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnitTolerance = 1e-3;
constexpr const char* kNoTask = "no row of a table in use has a weight: nothing would move";

std::string table_key(std::size_t table) {
  return "ik_match_table" + std::to_string(table + 1);
}

// reads values of one JSON object and notes each fault with the path to it
class Reader {
 public:
  Reader(const Json& json, Faults& faults) : json_(json), faults_(faults) {}

  const Json* find(const std::string& key) {
    const auto found = json_.find(key);
    if (found == json_.end()) {
      faults_.add("\"" + key + "\" is missing");
      return nullptr;
    }
    return &*found;
  }

  std::string text(const std::string& key) {
    const Json* value = find(key);
    if (value == nullptr) return {};
    if (value->is_string()) return value->get<std::string>();
    faults_.add("\"" + key + "\" must be a text, found " + value->dump());
    return {};
  }

  double number(const std::string& key) {
    const Json* value = find(key);
    return value == nullptr ? 0.0 : number(*value, "\"" + key + "\"");
  }

  double number(const Json& value, const std::string& what) {
    if (value.is_number() && std::isfinite(value.get<double>())) return value.get<double>();
    faults_.add(what + " must be a number, found " + value.dump());
    return 0.0;
  }

  // tables are used unless the file says otherwise
  bool flag(const std::string& key) {
    const auto found = json_.find(key);
    if (found == json_.end()) return true;
    if (found->is_boolean()) return found->get<bool>();
    faults_.add("\"" + key + "\" must be true or false, found " + found->dump());
    return true;
  }

  template <int kSize>
  std::optional<Eigen::Matrix<double, kSize, 1>> vector(const Json& value,
                                                        const std::string& what) {
    const auto is_finite_number = [](const Json& v) {
      return v.is_number() && std::isfinite(v.get<double>());
    };
    if (!value.is_array() || value.size() != kSize ||
        !std::all_of(value.begin(), value.end(), is_finite_number)) {
      faults_.add(what + " must be " + std::to_string(kSize) + " numbers, found " + value.dump());
      return std::nullopt;
    }
    Eigen::Matrix<double, kSize, 1> result;
    for (int i = 0; i < kSize; ++i) result[i] = value[i].template get<double>();
    return result;
  }

 private:
  const Json& json_;
  Faults& faults_;
};

IkRow read_row(Reader& reader, Faults& faults, const std::string& table, const std::string& body,
               const Json& json) {
  IkRow row;
  row.body = body;
  const std::string what = table + " of \"" + body + "\"";
  if (!json.is_array() || json.size() != 5 || !json[0].is_string()) {
    faults.add(what + " must be [bone, position weight, rotation weight, position offset, " +
               "rotation offset], found " + json.dump());
    return row;
  }
  row.bone = json[0].get<std::string>();
  row.position_weight = reader.number(json[1], "position weight in " + what);
  row.rotation_weight = reader.number(json[2], "rotation weight in " + what);
  if (row.position_weight < 0.0 || row.rotation_weight < 0.0) {
    faults.add("a weight in " + what + " is negative");
  }
  if (const auto offset = reader.vector<3>(json[3], "position offset in " + what)) {
    row.position_offset = *offset;
  }
  if (const auto wxyz = reader.vector<4>(json[4], "rotation offset in " + what)) {
    const double norm = wxyz->norm();
    if (std::abs(norm - 1.0) > kUnitTolerance) {
      faults.add("rotation offset in " + what +
                 " is no unit quaternion (w, x, y, z): its norm is " + std::to_string(norm));
    } else {
      const Eigen::Vector4d unit = *wxyz / norm;
      row.rotation_offset = Eigen::Quaterniond(unit[0], unit[1], unit[2], unit[3]);
    }
  }
  return row;
}

IkTable read_table(Reader& reader, Faults& faults, std::size_t number) {
  IkTable table;
  table.used = reader.flag("use_" + table_key(number));
  const Json* json = reader.find(table_key(number));
  if (json == nullptr) return table;
  if (!json->is_object()) {
    faults.add("\"" + table_key(number) + "\" must be an object of rows by robot body");
    return table;
  }
  for (const auto& [body, row] : json->items()) {
    table.rows.push_back(read_row(reader, faults, table_key(number), body, row));
  }
  return table;
}

IkTables read_tables(const Json& json, const std::string& file, Faults& faults) {
  Reader reader(json, faults);
  IkTables tables;
  tables.file = file;
  tables.robot_root = reader.text("robot_root_name");
  tables.human_root = reader.text("human_root_name");
  tables.ground_height = reader.number("ground_height");
  tables.human_height_assumption = reader.number("human_height_assumption");
  if (tables.human_height_assumption <= 0.0 && json.contains("human_height_assumption")) {
    faults.add("\"human_height_assumption\" must be more than 0");
  }
  if (const Json* scales = reader.find("human_scale_table")) {
    if (!scales->is_object()) faults.add("\"human_scale_table\" must be an object of numbers");
    for (const auto& [bone, scale] : scales->items()) {
      tables.scales.emplace_back(bone, reader.number(scale, "scale of \"" + bone + "\""));
    }
  }
  for (std::size_t number = 0; number < 2; ++number) {
    tables.tables[number] = read_table(reader, faults, number);
  }
  return tables;
}

// finds what the names of a mapping mean for a robot
class Resolver {
 public:
  Resolver(const IkTables& tables, const Robot& robot, Faults& faults)
      : tables_(tables), robot_(robot), bodies_(robot.body_names()), faults_(faults) {}

  ResolvedMapping resolve() {
    mapping_.file = tables_.file;
    mapping_.ground_height = tables_.ground_height;
    mapping_.human_height_assumption = tables_.human_height_assumption;
    for (const auto& [name, scale] : tables_.scales) {
      const auto bone = bone_from_name(name);
      if (!bone || has_scale_[*bone]) continue;
      mapping_.scales[*bone] = scale;
      has_scale_[*bone] = true;
    }
    resolve_roots();
    bool any_task = false;
    for (std::size_t number = 0; number < 2; ++number) {
      resolve_table(number);
      const auto& [used, tasks] = mapping_.tables[number];
      any_task = any_task || (used && std::ranges::any_of(tasks, &MappedTask::has_weight));
    }
    if (!any_task && faults_.empty()) faults_.add(kNoTask);
    return std::move(mapping_);
  }

 private:
  void resolve_roots() {
    const auto body = robot_.find_body(tables_.robot_root);
    mapping_.root_body = body.value_or(0);
    if (!body && !tables_.robot_root.empty()) {
      faults_.add("\"robot_root_name\": the robot has no body \"" + tables_.robot_root + "\"" +
                  did_you_mean(tables_.robot_root, bodies_));
    }
    const auto bone = bone_from_name(tables_.human_root);
    mapping_.root_bone = bone.value_or(Bone::kHips);
    if (tables_.human_root.empty()) return;
    if (!bone) {
      faults_.add("\"human_root_name\": no bone \"" + tables_.human_root + "\"" +
                  did_you_mean(tables_.human_root, bone_names()));
    } else if (!has_scale_[*bone]) {
      faults_.add("the root bone \"" + tables_.human_root +
                  "\" has no entry in \"human_scale_table\"");
    }
  }

  void resolve_table(std::size_t number) {
    const IkTable& table = tables_.tables[number];
    mapping_.tables[number].used = table.used;
    std::map<std::string, std::string> body_of_bone;
    for (const IkRow& row : table.rows) {
      const auto body = robot_.find_body(row.body);
      const auto bone = bone_from_name(row.bone);
      if (bone) {
        mapping_.tables[number].tasks.push_back({IkTask(row), body.value_or(-1), *bone});
      }
      if (!table.used) continue;
      check_row(row, table_key(number), body.has_value(), bone);
      if (!row.has_weight()) continue;
      const auto [found, is_new] = body_of_bone.try_emplace(row.bone, row.body);
      if (!is_new) {
        faults_.add(table_key(number) + ": the bone \"" + row.bone + "\" drives two bodies, \"" +
                    found->second + "\" and \"" + row.body + "\"");
      }
    }
  }

  void check_row(const IkRow& row, const std::string& table, bool has_body,
                 std::optional<Bone> bone) {
    if (!has_body) {
      faults_.add(table + ": the robot has no body \"" + row.body + "\"" +
                  faults_.suggestion(row.body, bodies_));
    }
    if (row.bone.empty()) return;  // a row that could not be read was named already
    if (!bone) {
      faults_.add(table + " of \"" + row.body + "\": no bone \"" + row.bone + "\"" +
                  faults_.suggestion(row.bone, bone_names()));
    } else if (!has_scale_[*bone]) {
      faults_.add(table + " of \"" + row.body + "\": the bone \"" + row.bone +
                  "\" has no entry in \"human_scale_table\"");
    }
  }

  const IkTables& tables_;
  const Robot& robot_;
  const std::vector<std::string> bodies_;
  Faults& faults_;
  BoneArray<bool> has_scale_;
  ResolvedMapping mapping_;
};

// reads a mapping's text and does something with it while faults are still collected
template <typename Use>
auto read_text(std::string_view text, const std::string& file, const Use& use)
    -> Result<decltype(use(IkTables(), std::declval<Faults&>()))> {
  TRY_ASSIGN(const auto json, parse_json(text, file));
  if (!json.is_object()) return config_failure(file, "a mapping must be a JSON object");
  Faults faults;
  auto result = use(read_tables(json, file, faults), faults);
  if (!faults.empty()) return faults.failure_in(file, "the mapping");
  return result;
}

}  // namespace

const double* IkTables::find_scale(std::string_view bone) const {
  const auto found = std::ranges::find(scales, bone, &std::pair<std::string, double>::first);
  return found == scales.end() ? nullptr : &found->second;
}

Result<IkTables> parse_ik_tables(std::string_view text, const std::string& file) {
  return read_text(text, file, [](IkTables tables, Faults&) { return tables; });
}

Result<IkTables> load_ik_tables(const std::string& path) {
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig, kMostTextBytes));
  return parse_ik_tables(text.view(), path);
}

Result<ResolvedMapping> resolve_mapping(const IkTables& tables, const Robot& robot) {
  Faults faults;
  auto mapping = Resolver(tables, robot, faults).resolve();
  if (!faults.empty()) return faults.failure_in(tables.file, "the mapping");
  return mapping;
}

Result<ResolvedMapping> load_mapping(const std::string& path, const Robot& robot) {
  TRY_ASSIGN(const auto text, read_file(path, ErrorKind::kConfig, kMostTextBytes));
  return read_text(text.view(), path, [&](const IkTables& tables, Faults& faults) {
    return Resolver(tables, robot, faults).resolve();
  });
}

const MappedTask* ResolvedMapping::find_task(Bone bone) const {
  const MappedTask* found = nullptr;
  for (const Table& table : tables) {
    for (const MappedTask& task : table.tasks) {
      if (task.bone != bone) continue;
      if (task.has_weight()) return &task;
      if (found == nullptr) found = &task;
    }
  }
  return found;
}

int ResolvedMapping::body_of(Bone bone) const {
  const MappedTask* const task = find_task(bone);
  return task == nullptr ? -1 : task->body;
}

Result<int> leave_out_bones(ResolvedMapping& mapping, std::span<const Bone> bones) {
  std::size_t dropped = 0;
  bool any_task = false;
  for (auto& [used, tasks] : mapping.tables) {
    dropped += std::erase_if(tasks, [&](const MappedTask& task) {
      return std::ranges::find(bones, task.bone) != bones.end();
    });
    any_task = any_task || (used && std::ranges::any_of(tasks, &MappedTask::has_weight));
  }
  if (!any_task) return config_failure(mapping.file, kNoTask);
  return static_cast<int>(dropped);
}

}  // namespace retarget
