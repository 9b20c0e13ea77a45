// A comparison of two motions for people.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <vector>

#include "base/number_text.h"
#include "io/compare_motions.h"
#include "retarget/error.h"

namespace retarget {
namespace {

constexpr std::size_t kColumnsShown = 5;

// enough digits for any difference, however small
std::string difference_text(double value) {
  constexpr int kDigits = 3;
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                          std::chars_format::general, kDigits);
  return std::string(digits.data(), end);
}

}  // namespace

std::vector<std::string> difference_lines(const MotionDifference& difference) {
  std::vector<std::string> lines = {fmt::format(
      "{} of {}, largest difference {}",
      count_text(std::min(difference.frames_a, difference.frames_b), "frame"),
      count_text(difference.column_count, "column"), difference_text(difference.largest))};
  for (std::size_t i = 0; i < std::min(difference.columns.size(), kColumnsShown); ++i) {
    const ColumnDifference& column = difference.columns[i];
    lines.push_back(fmt::format("{}: {} in frame {}, beyond the tolerance in {}, first in {}",
                                column.column, difference_text(column.largest),
                                column.largest_frame, count_text(column.frames_beyond, "frame"),
                                column.first_frame));
  }
  return lines;
}

Result<void> check_agreement(const MotionDifference& difference, double tolerance,
                             const std::string& a, const std::string& b) {
  if (difference.agree()) return {};
  if (difference.frames_a != difference.frames_b) {
    return run_failure(
        "", fmt::format("{} has {}, {} {}", a, count_text(difference.frames_a, "frame"), b,
                        difference.frames_b));
  }
  const ColumnDifference& worst = difference.columns.front();
  return run_failure(
      "", fmt::format("the motions differ in {} by more than {}, most in {}: {} in "
                      "frame {}",
                      count_text(difference.columns.size(), "column"), difference_text(tolerance),
                      worst.column, difference_text(worst.largest), worst.largest_frame));
}

}  // namespace retarget
