// Identifies the columns of a CSV by their names or by their index.

#include "formats/robot_motion/csv_columns.h"

#include <fmt/format.h>
#include <algorithm>
#include <set>
#include <span>

#include "base/option_name.h"
#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::size_t kRootColumns = 7;
constexpr std::size_t kNamesShown = 6;

constexpr const char* kByNumber = OPTION("ignore-header") " reads the columns by position";

std::string quoted(const std::vector<std::string>& names) {
  std::vector<std::string> shown;
  shown.reserve(names.size());
  for (const std::string& name : names) shown.push_back("\"" + name.substr(0, 60) + "\"");
  return list_names(shown, kNamesShown);
}

// Interprets a header; unknown() collects the names that it does not recognise.
class HeaderReader {
 public:
  HeaderReader(const std::vector<std::string>& cells, const Robot& robot)
      : robot_(robot), names_(column_names(cells)), joints_(robot) {
    for (std::size_t i = 0; i < names_.size(); ++i) take(names_[i], static_cast<int>(i));
    // Without a unit, a value next to others in degrees may be in radians, too.
    if (columns_.degrees.value_or(false) && !joint_without_unit_.empty()) {
      conflict_ = "joints in degrees, and \"" + joint_without_unit_ + "\" without a unit";
    }
    if (columns_.metres_per_unit.value_or(1.0) != 1.0 && !position_without_unit_.empty()) {
      conflict_ = "positions with a unit, and \"" + position_without_unit_ + "\" without a unit";
    }
  }

  [[nodiscard]] const CsvColumns& columns() const { return columns_; }
  [[nodiscard]] const std::vector<std::string>& unknown() const { return unknown_; }
  /// A duplicate meaning or contradictory units; empty if there are none.
  [[nodiscard]] const std::string& conflict() const { return conflict_; }

 private:
  void take(ColumnName name, int column) {
    if (const auto joint = joints_.find(name)) {
      take_joint(name, column, *joint);
      return;
    }
    if (take_root(name, column)) return;
    take_unit_suffix(name);
    if (const auto joint = joints_.find(name)) {
      take_joint(name, column, *joint);
    } else if (!take_clock(name, column) && !take_root(name, column)) {
      unknown_.push_back(name.given);
    }
  }

  void take_joint(const ColumnName& name, int column, int joint) {
    if (!seen_.insert(joint).second) conflict_ = "a joint twice: \"" + name.given + "\"";
    columns_.joints.emplace_back(column, joint);
    const bool slides =
        robot_.joints()[static_cast<std::size_t>(joint)].type == RobotJoint::Type::kSlide;
    if (name.unit.empty() && !slides) joint_without_unit_ = name.given;
    take_angle_unit(name);
  }

  void take_angle_unit(const ColumnName& name) {
    if (name.unit != "rad" && name.unit != "deg") return;
    const bool degrees = name.unit == "deg";
    if (columns_.degrees.value_or(degrees) != degrees) conflict_ = "radians and degrees";
    columns_.degrees = degrees;
  }

  void take_length_unit(const ColumnName& name) {
    const double unit = name.unit == "m"    ? 1.0
                        : name.unit == "cm" ? 0.01
                        : name.unit == "mm" ? 0.001
                                            : 0.0;
    if (unit == 0.0) return;
    if (columns_.metres_per_unit.value_or(unit) != unit) conflict_ = "lengths in two units";
    columns_.metres_per_unit = unit;
  }

  void put(int& place, int column, const ColumnName& name) {
    if (place != kNoColumn) conflict_ = "a part of the root twice: \"" + name.given + "\"";
    place = column;
  }

  bool take_clock(const ColumnName& name, int column) {
    static const std::set<std::string> kFrames = {"frame", "frames", "frame_id", "frame_index",
                                                  "frame_number"};
    static const std::set<std::string> kTimes = {"time", "t", "timestamp", "times", "stamp"};
    // pandas writes the index of a data frame without a name.
    static const std::set<std::string> kIndices = {"", "index", "unnamed/_0", "id"};
    const bool frames = kFrames.contains(name.plain), times = kTimes.contains(name.plain);
    if (!frames && !times && !(column == 0 && kIndices.contains(name.plain))) return false;
    // An index next to another clock adds nothing; times take precedence over frame numbers.
    if (columns_.clock != kNoColumn && !times) return true;
    if (columns_.clock_counts == CsvClock::kTimes) conflict_ = "two columns of times";
    columns_.clock = column;
    columns_.clock_counts = times    ? CsvClock::kTimes
                            : frames ? CsvClock::kFrames
                                     : CsvClock::kUnknown;
    columns_.seconds_per_tick = name.unit == "s"    ? 1.0
                                : name.unit == "ms" ? 1e-3
                                : name.unit == "us" ? 1e-6
                                : name.unit == "ns" ? 1e-9
                                                    : 0.0;
    return true;
  }

  bool take_root(const ColumnName& name, int column) {
    std::string plain = name.plain;
    std::ranges::replace(plain, '/', '_');
    for (const std::string_view prefix : {"floating_base_joint_", "floating_base_", "root_joint_",
                                          "base_link_", "root_", "base_", "pelvis_"}) {
      if (plain.size() > prefix.size() && plain.starts_with(prefix)) {
        plain.erase(0, prefix.size());
        break;
      }
    }
    if (plain.empty()) return false;
    const std::size_t axis = std::string_view("xyzw").find(plain.back());
    if (axis == std::string_view::npos) return false;
    plain.pop_back();
    if (plain.ends_with('_')) plain.pop_back();
    static const std::set<std::string> kPlaces = {"",      "pos", "p",         "position",
                                                  "trans", "t",   "translate", "translation"};
    static const std::set<std::string> kTurns = {"q",           "quat",     "rot",       "rot_q",
                                                 "orientation", "rotation", "quaternion"};
    if (kTurns.contains(plain) || (axis == 3 && plain.empty())) {
      put(columns_.quaternion[axis], column, name);
    } else if (axis < 3 && kPlaces.contains(plain)) {
      put(columns_.position[axis], column, name);
      columns_.soma = columns_.soma || plain == "translate";
      if (name.unit.empty()) position_without_unit_ = name.given;
      take_length_unit(name);
    } else if (axis < 3 && plain == "rotate") {
      put(columns_.euler[axis], column, name);
      take_angle_unit(name);
    } else {
      return false;
    }
    return true;
  }

  const Robot& robot_;
  std::vector<ColumnName> names_;
  JointNames joints_;
  CsvColumns columns_;
  std::string joint_without_unit_, position_without_unit_;  // The last ones; usually empty.
  std::set<int> seen_;                                      // Joints.
  std::vector<std::string> unknown_;
  std::string conflict_;
};

bool complete(std::span<const int> columns) {
  return std::ranges::find(columns, kNoColumn) == columns.end();
}

// Reports missing joints unless some variant of the robot lacks all of them.
Result<void> check_joints(const CsvColumns& columns, const Robot& robot, const std::string& file,
                          const ReadMotionOptions& options) {
  std::set<int> named;
  for (const auto& [column, joint] : columns.joints) named.insert(joint);
  const auto missing_of = [&](const std::string& variant) {
    const std::vector<int> all =
        variant.empty() ? robot.output_joints() : output_joints_of(robot, variant);
    std::vector<std::string> missing;
    for (const int joint : all) {
      if (!named.contains(joint)) missing.push_back(robot.joints()[joint].name);
    }
    return missing;
  };
  const std::vector<std::string> missing = missing_of(options.variant);
  if (missing.empty()) return {};
  if (options.variant.empty()) {
    for (const RobotVariant& variant : robot.profile().variants) {
      if (missing_of(variant.name).empty()) return {};
    }
  }
  return input_failure(
      file,
      "the header names " + std::to_string(named.size()) + " joints, but these of the robot " +
          robot.name() + " are missing: " + list_names(missing),
      "a file may omit the joints that a variant of the robot omits (retarget robots show)");
}

Result<CsvColumns> columns_by_name(const std::vector<std::string>& header, const Robot& robot,
                                   const std::string& file, const ReadMotionOptions& options) {
  const HeaderReader reader(header, robot);
  CsvColumns columns = reader.columns();
  if (columns.joints.empty()) {
    return input_failure(file,
                         "the header is not understood: " + quoted(header) +
                             " are not joints of the robot " + robot.name(),
                         kByNumber);
  }
  if (!reader.unknown().empty()) {
    const std::vector<std::string>& unknown = reader.unknown();
    return input_failure(file,
                         "the header names " + quoted(unknown) + ", which " +
                             (unknown.size() == 1 ? "is not a joint" : "are not joints") +
                             " of the robot " + robot.name() +
                             did_you_mean(unknown.front(), robot.joint_names()),
                         std::string(kByNumber) + "; otherwise remove these columns");
  }
  if (!reader.conflict().empty()) {
    return input_failure(file, "the header names " + reader.conflict());
  }
  columns.quaternion_named = complete(columns.quaternion);
  if (!complete(columns.position) || complete(columns.euler) == columns.quaternion_named) {
    return input_failure(file,
                         "the header names joints, but not the three columns of the root's "
                         "position and the four of its quaternion",
                         "use names such as root_x, root_qx");
  }
  TRY(check_joints(columns, robot, file, options));
  // SOMA's files use fixed units without naming them.
  if (columns.soma && !columns.degrees) columns.degrees = true;
  if (columns.soma && !columns.metres_per_unit) columns.metres_per_unit = 0.01;
  return columns;
}

bool counts_up(const CsvTable& table) {
  for (std::size_t i = 1; i < table.rows(); ++i) {
    if (!(table.row(i)[0] > table.row(i - 1)[0])) return false;
  }
  return true;
}

// Example: `36: 7 of the root and 29 joints; its variants need 30 (23)`
std::string needed_columns(const Robot& robot, const std::string& variant) {
  const std::size_t joints = output_joints_of(robot, variant).size();
  const std::string text =
      fmt::format("{}: {} of the root and {} joints", kRootColumns + joints, kRootColumns, joints);
  if (!variant.empty()) return text + " of its variant " + variant;
  std::vector<std::string> others;
  for (const RobotVariant& each : robot.profile().variants) {
    const std::size_t columns = kRootColumns + output_joints_of(robot, each.name).size();
    others.push_back(fmt::format("{} ({})", columns, each.name));
  }
  return others.empty() ? text : text + "; its variants need " + list_names(others);
}

Result<CsvColumns> columns_by_number(const CsvTable& table, const Robot& robot,
                                     const std::string& file, const ReadMotionOptions& options) {
  CsvColumns columns;
  RawMotion csv;
  // If the count does not fit, a first column that counts up may be a frame number.
  Result<std::vector<int>> joints = input_failure(file, "there are too few columns");
  int first = 0;
  const std::size_t found = table.columns;
  if (found > kRootColumns) {
    joints = joints_by_count(robot, found - kRootColumns, csv, file, options.variant);
    if (!joints && found > kRootColumns + 1 && counts_up(table)) {
      auto others = joints_by_count(robot, found - kRootColumns - 1, csv, file, options.variant);
      if (others) {
        joints = std::move(others);
        first = 1;
      }
    }
  }
  if (!joints) {
    const bool several =
        found > kRootColumns &&
        variants_by_count(robot, found - kRootColumns, csv.format, options.variant).size() > 1;
    if (several) return failure(joints.error());
    Failure fault =
        input_failure(file, fmt::format("this line has {} columns, the robot {} needs {}", found,
                                        robot.name(), needed_columns(robot, options.variant)));
    fault.value().location.line = table.lines.front();
    fault.value().location.column = 1;
    return fault;
  }
  if (first == 1) columns.clock = 0;
  for (int i = 0; i < 3; ++i) columns.position[i] = first + i;
  for (int i = 0; i < 4; ++i) columns.quaternion[i] = first + 3 + i;
  for (std::size_t i = 0; i < joints->size(); ++i) {
    columns.joints.emplace_back(first + static_cast<int>(kRootColumns + i), (*joints)[i]);
  }
  return columns;
}

}  // namespace

Result<CsvColumns> find_csv_columns(const CsvTable& table, const Robot& robot,
                                    const std::string& file, const ReadMotionOptions& options) {
  if (!options.ignore_header) {
    if (!table.header.empty()) return columns_by_name(table.header, robot, file, options);
    const bool names =
        !table.comment.empty() && !HeaderReader(table.comment, robot).columns().joints.empty();
    if (names) return columns_by_name(table.comment, robot, file, options);
  }
  return columns_by_number(table, robot, file, options);
}

}  // namespace retarget
