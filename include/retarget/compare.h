#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"
#include "retarget/motion.h"

namespace RETARGET_API retarget {

/// A motion as named columns of numbers, one row per frame.
struct MotionTable {
  std::vector<std::string> columns;
  /// First of the four columns of each quaternion; q and -q compare as equal.
  std::vector<std::size_t> quaternions;
  std::size_t frames = 0;
  std::vector<double> values;  ///< Row-major.
  /// Other numeric data by name: a rate, arrays without one row per frame.
  std::vector<std::pair<std::string, std::vector<double>>> others;
};

/// The table of a robot's motion: root position, root quaternion x y z w and all output joints.
[[nodiscard]] MotionTable motion_table(const RobotClip& clip);

/// Reads a file without knowledge of the robot. A CSV gives its columns, by name where it has a
/// header; columns 4 to 7, or 5 to 8 after a frame number, are a quaternion if they have unit
/// length. An NPZ or a pickle gives all numbers and numeric arrays; arrays with one row per frame
/// become columns. Errors (kInput): the errors of the file readers; a file without any column.
[[nodiscard]] Result<MotionTable> parse_motion_table(std::string_view bytes,
                                                     const std::string& file);

/// Reads a file as parse_motion_table does; `-` is standard input.
/// @param max_bytes  a larger file is an error (memory_share).
[[nodiscard]] Result<MotionTable> load_motion_table(const std::string& path, std::size_t max_bytes);

/// Difference of one column between two motions.
struct ColumnDifference {
  std::string column;
  double largest = 0.0;           ///< Infinite if a value is NaN.
  std::size_t largest_frame = 0;  ///< Frame of the largest difference.
  std::size_t first_frame = 0;    ///< First frame beyond the tolerance.
  std::size_t frames_beyond = 0;  ///< Number of frames beyond the tolerance.
};

/// Difference between two motions.
struct MotionDifference {
  std::size_t frames_a = 0, frames_b = 0;  ///< Only the frames that both motions have are compared.
  std::size_t column_count = 0;
  double largest = 0.0;
  std::vector<ColumnDifference> columns;  ///< Columns beyond the tolerance, worst first.
  /// True if no column is beyond the tolerance and the frame counts are equal.
  [[nodiscard]] bool agree() const { return columns.empty() && frames_a == frames_b; }
};

/// Compares two motions column by column, then their other data. A difference equal to the
/// tolerance, up to rounding, is within it. Errors (kInput): the motions have different columns.
[[nodiscard]] Result<MotionDifference> compare_motions(const MotionTable& a, const MotionTable& b,
                                                       double tolerance);

/// A summary with the largest difference, then one line per column, worst first.
[[nodiscard]] std::vector<std::string> difference_lines(const MotionDifference& difference);

/// Errors (kRun): the motions do not agree; the message states the largest difference and its
/// location.
/// @param a, b  names of the motions.
[[nodiscard]] Result<void> check_agreement(const MotionDifference& difference, double tolerance,
                                           const std::string& a, const std::string& b);

}  // namespace retarget
