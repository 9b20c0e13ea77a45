// Which columns of a CSV are what: by their names, else by their number.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "io/csv_table.h"
#include "io/raw_motion.h"
#include "retarget/base/number_text.h"
#include "retarget/base/suggest.h"
#include "retarget/math/so3.h"

namespace retarget {
namespace {

constexpr double kRadiansPerDegree = 0.01745329251994329577;
constexpr double kMetresPerCentimetre = 0.01;
constexpr std::size_t kRootColumns = 7;
constexpr double kFastestTimes = 1000.0;
constexpr int kNone = -1;

// where a CSV has what; kNone: nowhere
struct CsvColumns {
  int frame = kNone;
  std::array<int, 3> position = {kNone, kNone, kNone};
  std::array<int, 4> quaternion = {kNone, kNone, kNone, kNone};  // x y z w where names tell
  std::array<int, 3> euler = {kNone, kNone, kNone};
  bool quaternion_named = false;
  bool soma = false;
  std::optional<bool> degrees;
  std::vector<std::pair<int, int>> joints;  // column, index into Robot::joints()
};

std::string lower(std::string_view text) {
  std::string low(text);
  std::ranges::transform(low, low.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  });
  return low;
}

bool drop_prefix(std::string& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.erase(0, prefix.size());
  return true;
}

bool drop_suffix(std::string& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.erase(text.size() - suffix.size());
  return true;
}

// the joint that a column is named after: `knee`, `knee_dof`, `dof_knee(rad)`
std::optional<int> joint_of(std::string name, const Robot& robot, std::optional<bool>& degrees) {
  if (drop_suffix(name, "(rad)")) degrees = false;
  if (drop_suffix(name, "(deg)")) degrees = true;
  if (const auto joint = robot.find_joint(name)) return joint;
  drop_suffix(name, "_dof");
  drop_suffix(name, "_pos");
  drop_prefix(name, "dof_");
  return robot.find_joint(name);
}

// takes a column of the root by its name; false: it is another one
bool take_root_column(std::string name, int column, CsvColumns& columns) {
  if (name == "frame" || name == "time" || name == "t" || name == "timestamp" || name == "index") {
    columns.frame = column;
    return true;
  }
  for (const auto prefix : {"root_", "base_", "pelvis_", "floating_base_"}) {
    if (drop_prefix(name, prefix)) break;
  }
  constexpr std::string_view kAxes = "xyzw";
  for (std::size_t axis = 0; axis < 4; ++axis) {
    const std::string letter(1, kAxes[axis]);
    const bool is_quaternion = name == "q" + letter || name == "quat_" + letter ||
                               name == "rot_" + letter || name == "rot_q" + letter ||
                               name == "orientation_" + letter || name == "rotation_" + letter;
    if (is_quaternion || (axis == 3 && name == letter)) {
      columns.quaternion[axis] = column;
      return true;
    }
    if (axis == 3) break;
    if (name == letter || name == "pos_" + letter || name == "p" + letter ||
        name == "position_" + letter || name == "trans_" + letter) {
      columns.position[axis] = column;
      return true;
    }
    if (name == "translate" + letter) {
      columns.position[axis] = column;
      columns.soma = true;
      return true;
    }
    if (name == "rotate" + letter) {
      columns.euler[axis] = column;
      return true;
    }
  }
  return false;
}

bool complete(std::span<const int> columns) {
  return std::ranges::find(columns, kNone) == columns.end();
}

// columns by their names; nothing where the header names no joints
Result<std::optional<CsvColumns>> columns_by_name(const CsvTable& table, const Robot& robot,
                                                  const std::string& file) {
  CsvColumns columns;
  std::vector<std::string> unknown;
  for (std::size_t i = 0; i < table.header.size(); ++i) {
    const int column = static_cast<int>(i);
    if (const auto joint = joint_of(table.header[i], robot, columns.degrees)) {
      columns.joints.emplace_back(column, *joint);
    } else if (!take_root_column(lower(table.header[i]), column, columns)) {
      unknown.push_back(table.header[i]);
    }
  }
  if (columns.joints.empty()) return std::optional<CsvColumns>();
  if (!unknown.empty()) {
    return input_failure(file, "the header names \"" + unknown.front() +
                                   "\", which is no joint of the robot " + robot.name() +
                                   did_you_mean(unknown.front(), robot.joint_names()));
  }
  std::vector<int> named;
  for (const auto& [column, joint] : columns.joints) named.push_back(joint);
  std::ranges::sort(named);
  if (std::ranges::adjacent_find(named) != named.end()) {
    return input_failure(file, "the header names a joint twice");
  }
  columns.quaternion_named = complete(columns.quaternion);
  if (!complete(columns.position) || complete(columns.euler) == columns.quaternion_named) {
    return input_failure(file,
                         "the header names joints, but not three columns of the root's "
                         "position and four of its quaternion",
                         "names such as root_x, root_qx are known");
  }
  if (columns.soma) columns.degrees = true;
  return std::optional<CsvColumns>(columns);
}

bool counts_up(const CsvTable& table) {
  for (std::size_t i = 1; i < table.rows(); ++i) {
    if (!(table.row(i)[0] > table.row(i - 1)[0])) return false;
  }
  return true;
}

Result<CsvColumns> columns_by_number(const CsvTable& table, const Robot& robot,
                                     const std::string& file, const ReadMotionOptions& options,
                                     RawMotion& raw) {
  CsvColumns columns;
  // a number in front of the others, where what is left fits and it counts up
  Result<std::vector<int>> joints = input_failure(file, "there are too few columns");
  int first = 0;
  const std::size_t found = table.columns;
  if (found > kRootColumns) {
    joints = joints_by_count(robot, found - kRootColumns, raw, file, options.variant);
    if (!joints && found > kRootColumns + 1 && counts_up(table)) {
      auto others = joints_by_count(robot, found - kRootColumns - 1, raw, file, options.variant);
      if (others) {
        joints = std::move(others);
        first = 1;
      }
    }
  }
  if (!joints) {
    if (found > kRootColumns && joints.error().hint.starts_with("--source-dof")) {
      return failure(joints.error());
    }
    const std::size_t joint_count = robot.output_joints().size();
    return failure({.kind = ErrorKind::kInput,
                    .file = file,
                    .line = table.lines.front(),
                    .column = 1,
                    .message = "this line has " + std::to_string(found) + " columns, the robot " +
                               robot.name() + " needs " +
                               std::to_string(kRootColumns + joint_count) + ": 7 of the root and " +
                               std::to_string(joint_count) + " joints",
                    .hint = {}});
  }
  if (first == 1) columns.frame = 0;
  for (int i = 0; i < 3; ++i) columns.position[i] = first + i;
  for (int i = 0; i < 4; ++i) columns.quaternion[i] = first + 3 + i;
  for (std::size_t i = 0; i < joints->size(); ++i) {
    columns.joints.emplace_back(first + static_cast<int>(kRootColumns + i), (*joints)[i]);
  }
  return columns;
}

// a column of times gives the rate; one of frame numbers does not
void take_rate(const CsvTable& table, int column, RawMotion& raw) {
  if (column == kNone || table.rows() < 2) return;
  const auto at = static_cast<std::size_t>(column);
  const double length = table.row(table.rows() - 1)[at] - table.row(0)[at];
  const double step = length / static_cast<double>(table.rows() - 1);
  const bool steady = step > 1.0 / kFastestTimes && step < 0.5;
  raw.notes.push_back(steady
                          ? "a first column of times, " + number_text(1.0 / step, 3) + " a second"
                          : "a column of frame numbers, passed over");
  if (steady) raw.rate = frame_rate_from_frame_time(step);
}

// R = Rz Ry Rx of angles about fixed axes, as xyzw
std::array<double, 4> quaternion_of(const std::array<double, 3>& angles) {
  const Eigen::Quaterniond q = exp_so3(angles[2] * Eigen::Vector3d::UnitZ()) *
                               exp_so3(angles[1] * Eigen::Vector3d::UnitY()) *
                               exp_so3(angles[0] * Eigen::Vector3d::UnitX());
  return {q.x(), q.y(), q.z(), q.w()};
}

}  // namespace

Result<RawMotion> read_csv_motion(std::string_view text, const Robot& robot,
                                  const std::string& file, const ReadMotionOptions& options) {
  const auto table = read_csv_table(text, file);
  if (!table) return failure(table.error());
  RawMotion raw;
  auto named = columns_by_name(*table, robot, file);
  if (!named) return failure(named.error());
  if (!*named) {
    auto numbered = columns_by_number(*table, robot, file, options, raw);
    if (!numbered) return failure(numbered.error());
    *named = std::move(*numbered);
  }
  const CsvColumns& columns = **named;
  raw.format = columns.soma ? MotionFormat::kCsvSoma : MotionFormat::kCsv;
  raw.frames = table->rows();
  raw.joint_count = columns.joints.size();
  raw.degrees = columns.degrees;
  if (columns.soma) raw.metres_per_unit = kMetresPerCentimetre;
  for (const auto& [column, joint] : columns.joints) raw.joint_indices.push_back(joint);
  take_rate(*table, columns.frame, raw);
  const bool euler = !columns.quaternion_named && columns.euler[0] != kNone;
  if (columns.quaternion_named || euler) raw.order = QuaternionOrder::kXyzw;
  for (std::size_t i = 0; i < table->rows(); ++i) {
    const auto row = table->row(i);
    for (const int column : columns.position) raw.position.push_back(row[column]);
    if (euler) {
      const double unit = columns.degrees.value_or(true) ? kRadiansPerDegree : 1.0;
      const auto q = quaternion_of({unit * row[columns.euler[0]], unit * row[columns.euler[1]],
                                    unit * row[columns.euler[2]]});
      raw.rotation.insert(raw.rotation.end(), q.begin(), q.end());
    } else {
      for (const int column : columns.quaternion) raw.rotation.push_back(row[column]);
    }
    for (const auto& [column, joint] : columns.joints) raw.joints.push_back(row[column]);
  }
  return raw;
}

}  // namespace retarget
