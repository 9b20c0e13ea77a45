#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/csv_table.h"
#include "io/raw_motion.h"
#include "retarget/error.h"
#include "retarget/motion_io.h"
#include "retarget/robot.h"

namespace retarget {

/// A column that is not there.
inline constexpr int kNoColumn = -1;

/// What the column that goes up with time counts, as far as its name tells.
enum class CsvClock : unsigned char { kUnknown, kFrames, kTimes };

/// Where a CSV has what.
struct CsvColumns {
  int clock = kNoColumn;
  CsvClock clock_counts = CsvClock::kUnknown;
  double seconds_per_tick = 0.0;  ///< Of kTimes where the name tells; 0: by magnitude.
  std::array<int, 3> position = {kNoColumn, kNoColumn, kNoColumn};
  /// x y z w where names tell.
  std::array<int, 4> quaternion = {kNoColumn, kNoColumn, kNoColumn, kNoColumn};
  bool quaternion_named = false;
  /// Angles about the fixed axes x, y, z, in this order, in place of a quaternion.
  std::array<int, 3> euler = {kNoColumn, kNoColumn, kNoColumn};
  bool soma = false;
  std::optional<bool> degrees;              ///< Where the names tell.
  std::optional<double> metres_per_unit;    ///< Where the names tell.
  std::vector<std::pair<int, int>> joints;  ///< Column, index into Robot::joints().
};

/// The columns of a table: by the names of its header (or of a comment that names joints), else, or
/// with ReadMotionOptions::ignore_header, by their number.
///
/// Names are taken in any letter case, in quotes, with a path before them that all share
/// (`robot/`), with units behind them (`(rad)`, `[cm]`), joints also as `dof_NAME`, `NAME_dof`,
/// `NAME_pos` and without a final `_joint`.
/// Errors (kInput): names that are not understood; a thing that is named twice; joints of the robot
/// that no column has, unless one of its variants lacks them all; columns that are no known number.
[[nodiscard]] Result<CsvColumns> find_csv_columns(const CsvTable& table, const Robot& robot,
                                                  const std::string& file,
                                                  const ReadMotionOptions& options);

/// Takes the rate that the clock of a table tells into `motion`: times in s, ms, us or ns, or
/// SOMA's frame numbers, which count frames of 120 a second. What it does not tell, or tells
/// otherwise than the options, is noted there.
/// Errors (kInput): times that do not go up evenly, or may be frame numbers as well; with
/// ReadMotionOptions::rate these are warnings.
[[nodiscard]] Result<void> take_csv_rate(const CsvTable& table, const CsvColumns& columns,
                                         const std::string& file, const ReadMotionOptions& options,
                                         RawMotion& motion);

}  // namespace retarget
