#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/robot_motion/raw_motion.h"
#include "retarget/csv_table.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"

namespace retarget {

/// A column name without common decorations.
struct ColumnName {
  std::string given;  ///< Name in the file.
  /// Lower case, with `_` for spaces, without quotes and units; path components separated by `/`.
  std::string plain;
  std::string unit;  ///< `rad`, `deg`, `m`, `cm`, `mm`, `s`, `ms`, `us`, `ns`, or empty.
};

/// Normalises the names of a header; removes a first path component that all of them share.
[[nodiscard]] std::vector<ColumnName> column_names(const std::vector<std::string>& cells);

/// Moves a unit suffix after `_` from the name to `unit`: `time_ms`.
void take_unit_suffix(ColumnName& name);

/// Finds the joint that a column name refers to.
class JointNames {
 public:
  explicit JointNames(const Robot& robot);
  /// Index into Robot::joints().
  [[nodiscard]] std::optional<int> find(const ColumnName& name) const;

 private:
  [[nodiscard]] std::optional<int> find_plain(std::string name) const;

  const Robot& robot_;
  std::map<std::string, std::optional<int>, std::less<>> by_plain_name_;  // No value: ambiguous.
};

/// Index of a missing column.
inline constexpr int kNoColumn = -1;

/// Unit of the clock column, which increases with time, as given by its name.
enum class CsvClock : unsigned char { kUnknown, kFrames, kTimes };

/// The meaning of the columns of a CSV.
struct CsvColumns {
  int clock = kNoColumn;
  CsvClock clock_counts = CsvClock::kUnknown;
  double seconds_per_tick = 0.0;  ///< Duration of a tick of kTimes, if the name gives the unit; 0:
                                  ///< inferred from the magnitude.
  std::array<int, 3> position = {kNoColumn, kNoColumn, kNoColumn};
  /// x y z w if the names give the order.
  std::array<int, 4> quaternion = {kNoColumn, kNoColumn, kNoColumn, kNoColumn};
  bool quaternion_named = false;
  /// Angles about the fixed axes x, y, z, in this order, instead of a quaternion.
  std::array<int, 3> euler = {kNoColumn, kNoColumn, kNoColumn};
  bool soma = false;
  std::optional<bool> degrees;              ///< Set if the names give the unit.
  std::optional<double> metres_per_unit;    ///< Set if the names give the unit.
  std::vector<std::pair<int, int>> joints;  ///< Column and index into Robot::joints().
};

/// Identifies the columns of a table by the names in its header (or in a comment that names
/// joints). Without names, or with ReadMotionOptions::ignore_header, columns are identified by
/// their index.
///
/// Names are matched in any letter case, in quotes, with a path prefix shared by all names
/// (`robot/`), and with unit suffixes (`(rad)`, `[cm]`). Joints also match as `dof_NAME`,
/// `NAME_dof`, `NAME_pos` and without a final `_joint`.
/// Errors (kInput): unknown names; duplicate names; missing joints of the robot, unless one of its
/// variants lacks all of them; a number of columns that fits no layout.
[[nodiscard]] Result<CsvColumns> find_csv_columns(const CsvTable& table, const Robot& robot,
                                                  const std::string& file,
                                                  const ReadMotionOptions& options);

/// Sets the rate of `motion` from the clock column of a table: times in s, ms, us or ns, or SOMA's
/// frame numbers, which count frames at 120 fps. Adds a note if the clock does not determine the
/// rate or contradicts the options.
/// Errors (kInput): times that do not increase evenly, or that may also be frame numbers. With
/// ReadMotionOptions::rate these are warnings.
[[nodiscard]] Result<void> take_csv_rate(const CsvTable& table, const CsvColumns& columns,
                                         const std::string& file, const ReadMotionOptions& options,
                                         RawMotion& motion);

}  // namespace retarget
