#include "pipeline/ik_tables.h"

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
#include "human/bones.h"

namespace retarget {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnitTolerance = 1e-3;

std::string table_key(int table) {
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

IkTable read_table(Reader& reader, Faults& faults, int number) {
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

void check_row(const IkRow& row, const std::string& table, const IkTables& tables,
               const std::vector<std::string>& bodies, Faults& faults) {
  if (std::ranges::find(bodies, row.body) == bodies.end()) {
    faults.add(table + ": the robot has no body \"" + row.body + "\"" +
               faults.suggestion(row.body, bodies));
  }
  if (row.bone.empty()) return;  // a row that could not be read was named already
  if (!find_bone(row.bone)) {
    faults.add(table + " of \"" + row.body + "\": no bone \"" + row.bone + "\"" +
               faults.suggestion(row.bone, bone_names()));
  } else if (tables.find_scale(row.bone) == nullptr) {
    faults.add(table + " of \"" + row.body + "\": the bone \"" + row.bone +
               "\" has no entry in \"human_scale_table\"");
  }
}

void check_table(int number, const IkTables& tables, const std::vector<std::string>& bodies,
                 Faults& faults) {
  std::map<std::string, std::string> body_of_bone;
  for (const IkRow& row : tables.tables[number].rows) {
    check_row(row, table_key(number), tables, bodies, faults);
    if (!row.has_weight()) continue;
    const auto [found, is_new] = body_of_bone.try_emplace(row.bone, row.body);
    if (!is_new) {
      faults.add(table_key(number) + ": the bone \"" + row.bone + "\" drives two bodies, \"" +
                 found->second + "\" and \"" + row.body + "\"");
    }
  }
}

}  // namespace

const double* IkTables::find_scale(std::string_view bone) const {
  const auto found = std::ranges::find(scales, bone, &std::pair<std::string, double>::first);
  return found == scales.end() ? nullptr : &found->second;
}

const IkRow* IkTables::find_row(std::string_view bone) const {
  const auto wanted = find_bone(bone);
  const IkRow* found = nullptr;
  for (const IkTable& table : tables) {
    for (const IkRow& row : table.rows) {
      if (row.bone != bone && (!wanted || find_bone(row.bone) != wanted)) continue;
      if (row.has_weight()) return &row;
      if (found == nullptr) found = &row;
    }
  }
  return found;
}

namespace {

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
  for (int number = 0; number < 2; ++number) {
    tables.tables[number] = read_table(reader, faults, number);
  }
  return tables;
}

void check_tables(const IkTables& tables, const Robot& robot, Faults& faults) {
  const std::vector<std::string> bodies = robot.body_names();
  if (!tables.robot_root.empty() && std::ranges::find(bodies, tables.robot_root) == bodies.end()) {
    faults.add("\"robot_root_name\": the robot has no body \"" + tables.robot_root + "\"" +
               did_you_mean(tables.robot_root, bodies));
  }
  if (!tables.human_root.empty()) {
    if (!find_bone(tables.human_root)) {
      faults.add("\"human_root_name\": no bone \"" + tables.human_root + "\"" +
                 did_you_mean(tables.human_root, bone_names()));
    } else if (tables.find_scale(tables.human_root) == nullptr) {
      faults.add("the root bone \"" + tables.human_root +
                 "\" has no entry in \"human_scale_table\"");
    }
  }
  bool any_task = false;
  for (int number = 0; number < 2; ++number) {
    if (!tables.tables[number].used) continue;
    check_table(number, tables, bodies, faults);
    any_task = any_task || std::ranges::any_of(tables.tables[number].rows, &IkRow::has_weight);
  }
  if (!any_task && faults.empty()) {
    faults.add("no row of a table in use has a weight: nothing would move");
  }
}

Result<IkTables> tables_from(std::string_view text, const std::string& file, const Robot* robot) {
  const auto json = parse_json(text, file);
  if (!json) return failure(json.error());
  if (!json->is_object()) return config_failure(file, "a mapping must be a JSON object");
  Faults faults;
  IkTables tables = read_tables(*json, file, faults);
  if (robot != nullptr) check_tables(tables, *robot, faults);
  if (!faults.empty()) return faults.failure_in(file, "the mapping");
  return tables;
}

}  // namespace

Result<IkTables> parse_ik_tables(std::string_view text, const std::string& file) {
  return tables_from(text, file, nullptr);
}

Result<IkTables> load_ik_tables(const std::string& path, const Robot* robot) {
  const auto text = read_file(path, ErrorKind::kConfig, kMostTextBytes);
  if (!text) return failure(text.error());
  return tables_from(text->view(), path, robot);
}

int leave_out_bones(IkTables& tables, std::span<const std::string> bones) {
  std::size_t dropped = 0;
  for (IkTable& table : tables.tables) {
    dropped += std::erase_if(table.rows, [&](const IkRow& row) {
      return std::ranges::find(bones, row.bone) != bones.end();
    });
  }
  return static_cast<int>(dropped);
}

Result<void> check_ik_tables(const IkTables& tables, const Robot& robot) {
  Faults faults;
  check_tables(tables, robot, faults);
  if (!faults.empty()) return faults.failure_in(tables.file, "the mapping");
  return {};
}

}  // namespace retarget
