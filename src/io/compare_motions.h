#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/motion.h"

namespace retarget {

/// A motion as named columns of numbers, one row per frame.
struct MotionTable {
  std::vector<std::string> columns;
  /// First of four columns that are one quaternion: q and -q there are the same.
  std::vector<std::size_t> quaternions;
  std::size_t frames = 0;
  std::vector<double> values;  ///< Row by row.
  /// Numbers that are not columns, by name: a rate, arrays without one row per frame.
  std::vector<std::pair<std::string, std::vector<double>>> others;
};

/// Root position, root quaternion xyzw and all output joints.
[[nodiscard]] MotionTable motion_table(const RobotClip& clip);

/// What a file holds, without knowing the robot: the columns of a CSV (by their names where it has
/// a header; columns 4 to 7, or after a frame number 5 to 8, as a quaternion where they are of unit
/// length), or all numbers and arrays of numbers of an NPZ or a pickle, those with one row per
/// frame as columns. Errors (kInput): those of the readers of such files; a file without any
/// column.
[[nodiscard]] Result<MotionTable> parse_motion_table(std::string_view bytes,
                                                     const std::string& file);

/// How a column of two motions differs.
struct ColumnDifference {
  std::string column;
  double largest = 0.0;           ///< Infinite where one is no number.
  std::size_t largest_frame = 0;  ///< Where.
  std::size_t first_frame = 0;    ///< The first frame beyond the tolerance.
  std::size_t frames_beyond = 0;
};

struct MotionDifference {
  std::size_t frames_a = 0, frames_b = 0;  ///< The frames that both have are compared.
  std::size_t column_count = 0;
  double largest = 0.0;
  std::vector<ColumnDifference> columns;  ///< Those beyond the tolerance, the worst first.
  /// Not beyond it, and with as many frames.
  [[nodiscard]] bool agree() const { return columns.empty() && frames_a == frames_b; }
};

/// Compares column by column, then what is no column. A difference of the tolerance itself, give or
/// take rounding, is not beyond it. Errors (kInput): other columns.
[[nodiscard]] Result<MotionDifference> compare_motions(const MotionTable& a, const MotionTable& b,
                                                       double tolerance);

/// What was compared and the largest difference; below, a line for each of the worst columns.
[[nodiscard]] std::vector<std::string> difference_lines(const MotionDifference& difference);

/// Errors (kRun): the motions do not agree; how much, and where.
/// @param a, b  their names.
[[nodiscard]] Result<void> check_agreement(const MotionDifference& difference, double tolerance,
                                           const std::string& a, const std::string& b);

}  // namespace retarget
