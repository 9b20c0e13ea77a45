#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "formats/bvh/source_text.h"
#include "retarget/clip.h"
#include "retarget/error.h"

namespace retarget {

/// The lines between MOTION and the first row.
struct MotionHeader {
  std::int64_t frames = 0;
  std::size_t frames_place = 0;      ///< Byte offset of the frame count.
  std::optional<double> frame_time;  ///< Seconds, as written; may be zero or negative.
  std::size_t frame_time_place = 0;  ///< Byte offset of the frame time.
};

/// Parses `Frames:` and `Frame Time:`, in either order, from after MOTION up to the first row.
/// @param needs_frame_time  whether a missing or non-positive frame time is an error.
[[nodiscard]] Result<MotionHeader> parse_motion_header(const SourceText& source, Scanner& scanner,
                                                       bool needs_frame_time);

/// Decodes motion rows into frames of a clip.
///
/// Rotation channels, in degrees, compose left to right (intrinsic) and act on column vectors:
/// `Zrotation Yrotation Xrotation` is Rz * Ry * Rx. A position channel replaces its component of
/// the joint's offset; scale channels are ignored.
class RowDecoder {
 public:
  /// @param first_column  column of the skeleton's first channel in a row.
  RowDecoder(const Skeleton& skeleton, int first_column);

  /// @pre row holds at least first_column + skeleton.channel_count() values.
  void decode(std::span<const double> row, Clip& clip, int frame);

 private:
  struct Step {
    int column;
    int target;  // Joint of a rotation, translation slot of a position.
    int axis;
  };

  std::vector<Step> rotations_;
  std::vector<Step> positions_;
  // Buffers of a frame, indexed like rotations_. Separate arrays let the compiler vectorise loops.
  std::vector<double> angles_;
  std::vector<double> sines_;
  std::vector<double> cosines_;
};

/// Tracks how motion rows are distributed over lines while they are read as one stream of values.
///
/// The stream alone cannot detect that one row lacks a value and another has one too many; all
/// columns in between would be shifted. The line lengths reveal this.
class RowLayout {
 public:
  /// A line that begins with a new row.
  struct Line {
    std::size_t begin = 0;   ///< Byte offset of its first value.
    std::size_t values = 0;  ///< Number of its values, once its end is reached.
    int rows = 0;            ///< Complete rows before it.
    bool neat = true;        ///< Whether each earlier line held exactly one row.
  };

  explicit RowLayout(std::size_t row_width) : width_(row_width) {}

  /// @param begin   byte offset of the line's first value.
  /// @param column  values of the current row on earlier lines.
  /// @param rows    complete rows before the line.
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
    // The row ends inside a line that it does not begin, or begins inside a line that it does not
    // end.
    const bool runs_over =
        column_ > 0 ? column_ + values > width_ : values > width_ && values % width_ != 0;
    if (runs_over && !deviation_) deviation_ = aligned_;
  }

  /// The latest line that began with a new row.
  [[nodiscard]] const Line& latest() const { return aligned_; }

  /// The last aligned line before rows first ceased to begin and end with lines.
  [[nodiscard]] const std::optional<Line>& deviation() const { return deviation_; }

  /// Whether each row normally takes one line, even if some lines deviate.
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

struct MotionRowsOptions {
  std::size_t row_width = 0;       ///< Values per row, at least 1.
  std::int64_t declared_rows = 0;  ///< Value of `Frames:`.
  std::size_t declared_place = 0;  ///< Byte offset of that number.
  bool lenient = false;            ///< Keep the complete rows of a damaged file.
};

struct MotionRows {
  int count = 0;
  std::vector<Warning> warnings;
};

/// Receives row `index`; a later call with the same index replaces it.
using RowSink = std::function<void(int index, std::span<const double> row)>;

/// Parses motion rows from the scanner's position to the end of the text. The sink may also receive
/// rows that later prove damaged; only those below `count` are valid.
/// @pre the rest of the text is too short for more rows than an int can count.
[[nodiscard]] Result<MotionRows> parse_motion_rows(const SourceText& source, Scanner& scanner,
                                                   const MotionRowsOptions& options,
                                                   const RowSink& sink);

}  // namespace retarget
