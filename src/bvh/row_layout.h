#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace retarget {

/// How motion rows lie on lines, noted while they are read as one stream of values.
///
/// A stream of values cannot see that one row has a value too few and another one too many: all
/// columns between would be shifted. The lines tell.
class RowLayout {
 public:
  /// A line at which rows before it were complete.
  struct Line {
    std::size_t begin = 0;   ///< Byte offset of its first value.
    std::size_t values = 0;  ///< Number of its values, once its end was seen.
    int rows = 0;            ///< Complete rows before it.
    bool neat = true;        ///< Whether each line before it held exactly one row.
  };

  explicit RowLayout(std::size_t row_width) : width_(row_width) {}

  /// @param begin   byte offset of the line's first value.
  /// @param column  values of the current row on lines before.
  /// @param rows    complete rows before.
  void begin_line(std::size_t begin, std::size_t column, int rows) {
    column_ = column;
    if (column == 0) aligned_ = {begin, 0, rows, neat_};
  }

  void end_line(std::size_t values) {
    assert(width_ > 0);
    ++lines_;
    if (values == width_) ++exact_lines_;
    if (column_ == 0) aligned_.values = values;
    neat_ = neat_ && column_ == 0 && values == width_;
    // a row that ends within a line it did not begin, or begins within one it does not end
    const bool runs_over =
        column_ > 0 ? column_ + values > width_ : values > width_ && values % width_ != 0;
    if (runs_over && !deviation_) deviation_ = aligned_;
  }

  /// The latest line that began with a new row.
  [[nodiscard]] const Line& latest() const { return aligned_; }

  /// Where rows first ceased to begin and end with lines.
  [[nodiscard]] const std::optional<Line>& deviation() const { return deviation_; }

  /// Whether the lines show that a row is a line, even if not every line is a row.
  [[nodiscard]] bool is_line_by_line(std::int64_t declared_rows) const {
    return static_cast<std::int64_t>(lines_) == declared_rows || 2 * exact_lines_ > lines_;
  }

 private:
  std::size_t width_;
  std::size_t column_ = 0;
  std::size_t lines_ = 0;
  std::size_t exact_lines_ = 0;
  bool neat_ = true;
  Line aligned_;
  std::optional<Line> deviation_;
};

}  // namespace retarget
