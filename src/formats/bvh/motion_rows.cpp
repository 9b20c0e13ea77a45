#include "formats/bvh/motion_rows.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/option_name.h"
#include "formats/bvh/euler_angles.h"
#include "formats/bvh/number_parser.h"

namespace retarget {
namespace {

constexpr const char* kLenientHint = OPTION("lenient") " keeps the complete rows";

class RowsParser {
 public:
  RowsParser(const SourceText& source, Scanner& scanner, const MotionRowsOptions& options,
             const RowSink& sink)
      : source_(source),
        scanner_(scanner),
        options_(options),
        sink_(sink),
        layout_(options.row_width),
        row_(options.row_width + kNumberLineSlack) {}

  Result<MotionRows> parse();

 private:
  enum class Stop { kEnd, kTrailingText, kBadValue };

  struct Lines {
    int good = 0;
    int bad = 0;
    bool moved_up = false;  // A good line follows a bad one.
  };

  Stop read_stream();
  bool read_neat_line(std::size_t begin);
  void take_row();
  bool at_trailing_text() const;
  std::optional<Error> find_damage(Stop stop) const;
  Error bad_value() const;
  Error wrong_length(const RowLayout::Line& line) const;
  Result<MotionRows> keep_complete_rows(const Error& damage);
  Lines read_lines(std::size_t begin, int first_row, bool store);
  bool read_line(std::size_t* values);
  void note_row_count(MotionRows& rows) const;

  bool too_few() const { return rows_ < options_.declared_rows; }
  std::size_t width() const { return options_.row_width; }

  const SourceText& source_;
  Scanner& scanner_;
  const MotionRowsOptions& options_;
  const RowSink& sink_;
  RowLayout layout_;
  const ReadNumberLine read_number_line_ = fastest_number_line_reader();
  int lines_declined_ = 0;   // Lines that the fast reader declined, minus those it read.
  std::vector<double> row_;  // One row plus the slack of the fast reader.
  std::size_t column_ = 0;   // Values of the current row.
  int rows_ = 0;             // Complete rows.
};

// Whether a number may end at `at`.
bool number_may_end(const char* at, const char* end) {
  return at == end || is_space(*at);
}

// Reads all values as one stream, ignoring line ends. Leaves the scanner where it stopped.
RowsParser::Stop RowsParser::read_stream() {
  const char* const begin = source_.text().data();
  const char* const end = begin + source_.text().size();
  const char* at = begin + scanner_.offset();
  std::size_t values_on_line = 0;
  while (true) {
    bool line_ended = false;
    for (; at < end && is_space(*at); ++at) line_ended |= is_line_end(*at);
    if ((line_ended || at == end) && values_on_line > 0) {
      layout_.end_line(std::exchange(values_on_line, 0));
    }
    scanner_.move_to(static_cast<std::size_t>(at - begin));
    if (at == end) return Stop::kEnd;
    if (values_on_line == 0) {
      layout_.begin_line(scanner_.offset(), column_, rows_);
      if (read_neat_line(scanner_.offset())) {
        at = begin + scanner_.offset();
        values_on_line = width();
        continue;
      }
    }

    const ParsedNumber number = parse_number(at, end);
    if (number.status == NumberStatus::kOk && number_may_end(number.end, end)) {
      row_[column_] = number.value;
      at = number.end;
      ++values_on_line;
      if (++column_ == width()) take_row();
    } else if (scanner_.at_comment()) {
      scanner_.skip_space();
      // Skipping a comment also skips its line end.
      if (values_on_line > 0) layout_.end_line(std::exchange(values_on_line, 0));
      at = begin + scanner_.offset();
    } else {
      if (!at_trailing_text()) return Stop::kBadValue;
      if (values_on_line > 0) layout_.end_line(values_on_line);
      return Stop::kTrailingText;
    }
  }
}

void RowsParser::take_row() {
  sink_(rows_, {row_.data(), width()});
  column_ = 0;
  ++rows_;
}

// Reads a line that is exactly one row if the fast reader accepts it. Leaves the scanner at the
// line's end.
bool RowsParser::read_neat_line(std::size_t begin) {
  // Stop trying the fast reader when it declines most lines, because each attempt costs time.
  constexpr int kMaxDeclined = 16;
  if (column_ > 0 || lines_declined_ > kMaxDeclined) return false;
  const std::size_t end = read_number_line_(source_.text(), begin, width(), row_);
  if (end == std::string_view::npos) {
    ++lines_declined_;
    return false;
  }
  lines_declined_ = std::max(lines_declined_ - 1, 0);
  scanner_.move_to(end);
  take_row();
  return true;
}

// Old files carry other data after the last row, which a malformed number is not.
bool RowsParser::at_trailing_text() const {
  if (column_ > 0 || too_few()) return false;
  const std::string_view token = scanner_.token();
  const ParsedNumber number = parse_number(token.data(), token.data() + token.size());
  return number.status == NumberStatus::kMalformed && token.front() != '\0' &&
         !is_nan_or_infinity(token);
}

Error RowsParser::bad_value() const {
  std::string role = "value " + std::to_string(column_ + 1) + " of " + std::to_string(width()) +
                     " in row " + std::to_string(rows_ + 1);
  if (too_few()) role += " of " + std::to_string(options_.declared_rows);
  Error error = number_failure(source_, scanner_.offset(), role).value();
  if (error.hint.empty() && (rows_ > 0 || is_nan_or_infinity(scanner_.token()))) {
    error.hint = kLenientHint;
  }
  return error;
}

Error RowsParser::wrong_length(const RowLayout::Line& line) const {
  return source_.error_at(line.begin,
                          "expected rows of " + std::to_string(width()) +
                              " values, one per channel of HIERARCHY, found " +
                              std::to_string(line.values) + " on this line",
                          kLenientHint);
}

std::optional<Error> RowsParser::find_damage(Stop stop) const {
  const std::size_t place = scanner_.offset();
  if (stop == Stop::kBadValue) return bad_value();
  const bool as_declared = rows_ == options_.declared_rows && column_ == 0;
  if (layout_.deviation() && (!as_declared || layout_.is_line_by_line(options_.declared_rows))) {
    return wrong_length(*layout_.deviation());
  }
  if (column_ > 0) {
    return source_.error_at(layout_.latest().begin,
                            "expected " + std::to_string(width()) + " values in row " +
                                std::to_string(rows_ + 1) + ", which begins here, found " +
                                std::to_string(column_) + " before the end of the file",
                            "the file seems to be truncated" +
                                (rows_ > 0 ? std::string("; ") + kLenientHint : std::string()));
  }
  if (too_few()) {
    return source_.error_at(
        place,
        "expected " + std::to_string(options_.declared_rows) +
            " rows, as declared by Frames on line " +
            std::to_string(source_.line_of(options_.declared_place)) + ", found " +
            std::to_string(rows_) + " before the end of the file",
        rows_ > 0 ? std::string("the file seems to be truncated; ") + kLenientHint : "");
  }
  return std::nullopt;
}

void RowsParser::note_row_count(MotionRows& rows) const {
  if (rows.count <= options_.declared_rows) return;
  rows.warnings.push_back(source_.warning_at(
      options_.declared_place, "Frames declares " + std::to_string(options_.declared_rows) +
                                   ", the file has " + std::to_string(rows.count) +
                                   " rows: all are read"));
}

Result<MotionRows> RowsParser::parse() {
  const Stop stop = read_stream();
  if (const std::optional<Error> damage = find_damage(stop)) {
    if (options_.lenient) return keep_complete_rows(*damage);
    return failure(*damage);
  }
  MotionRows rows;
  rows.count = rows_;
  note_row_count(rows);
  if (stop == Stop::kTrailingText) {
    rows.warnings.push_back(source_.warning_at(
        scanner_.offset(), "text after the last frame ignored: " +
                               source_.found_at(scanner_.offset()) + " and the rest"));
  }
  return rows;
}

// If each row takes one line, drops only the damaged lines; otherwise keeps the rows before the
// damage.
Result<MotionRows> RowsParser::keep_complete_rows(const Error& damage) {
  const RowLayout::Line resume = layout_.deviation().value_or(layout_.latest());
  MotionRows rows;
  rows.count = layout_.deviation() ? resume.rows : rows_;
  std::string dropped;
  if (column_ > 0 || layout_.deviation() || !scanner_.at_end()) {
    dropped = "; the rest of the file was dropped";
    const Lines lines = resume.neat ? read_lines(resume.begin, resume.rows, false) : Lines{};
    if (resume.neat && resume.rows + lines.good >= rows.count) {
      read_lines(resume.begin, resume.rows, true);
      rows.count = resume.rows + lines.good;
      dropped = "; dropped " + std::to_string(lines.bad) + " damaged line" +
                (lines.bad == 1 ? "" : "s") + (lines.moved_up ? ", later frames come earlier" : "");
    }
  }
  if (rows.count == 0) return failure(damage);
  note_row_count(rows);
  rows.warnings.push_back({damage.location.line, damage.location.column,
                           damage.message + ": kept " + std::to_string(rows.count) + " of " +
                               std::to_string(options_.declared_rows) + " declared rows" +
                               dropped});
  return rows;
}

RowsParser::Lines RowsParser::read_lines(std::size_t begin, int first_row, bool store) {
  Lines lines;
  scanner_.move_to(begin);
  scanner_.skip_space();
  while (!scanner_.at_end()) {
    std::size_t values = 0;
    if (read_line(&values) && values == width()) {
      if (store) sink_(first_row + lines.good, {row_.data(), width()});
      ++lines.good;
      lines.moved_up = lines.bad > 0;
    } else {
      ++lines.bad;
    }
    scanner_.skip_line();
    scanner_.skip_space();
  }
  return lines;
}

// Reads the numbers of one line, the first of them into row_. Returns false if there is anything
// else.
bool RowsParser::read_line(std::size_t* values) {
  const char* const begin = source_.text().data();
  const char* const end = begin + source_.text().size();
  while (true) {
    scanner_.skip_blanks();
    const char* at = begin + scanner_.offset();
    if (at == end || is_line_end(*at) || scanner_.at_comment()) return true;
    const ParsedNumber number = parse_number(at, end);
    if (number.status != NumberStatus::kOk || !number_may_end(number.end, end)) return false;
    if (*values < width()) row_[*values] = number.value;
    ++*values;
    scanner_.move_to(static_cast<std::size_t>(number.end - begin));
  }
}

}  // namespace

Result<MotionRows> parse_motion_rows(const SourceText& source, Scanner& scanner,
                                     const MotionRowsOptions& options, const RowSink& sink) {
  return RowsParser(source, scanner, options, sink).parse();
}

namespace {

// Valid range of portable::sin_cos_of_half_degrees.
constexpr double kMaxAngle = 1e15;

// A separate loop without other memory accesses, so that compilers can vectorise it.
void half_angles(std::span<const double> degrees, double* __restrict sines,
                 double* __restrict cosines) {
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    const auto [sine, cosine] = portable::sin_cos_of_half_degrees(degrees[i]);
    sines[i] = sine;
    cosines[i] = cosine;
  }
}

}  // namespace

RowDecoder::RowDecoder(const Skeleton& skeleton, int first_column) {
  int column = first_column;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    for (const Channel channel : skeleton.joint(joint).channels) {
      if (is_rotation(channel)) {
        rotations_.push_back({column, joint, axis_of(channel)});
      } else if (is_position(channel)) {
        positions_.push_back({column, skeleton.translation_slot(joint), axis_of(channel)});
      }
      ++column;
    }
  }
  angles_.resize(rotations_.size());
  sines_.resize(rotations_.size());
  cosines_.resize(rotations_.size());
}

void RowDecoder::decode(std::span<const double> row, Clip& clip, int frame) {
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    const double angle = row[rotations_[i].column];
    // The remainder is exact. Its period is two turns because half the angle is used.
    angles_[i] = std::abs(angle) < kMaxAngle ? angle : std::remainder(angle, 720.0);
  }
  half_angles(angles_, sines_.data(), cosines_.data());
  const auto rotations = clip.rotations(frame);
  std::ranges::fill(rotations, Eigen::Quaterniond::Identity());
  for (std::size_t i = 0; i < rotations_.size(); ++i) {
    rotate_about(rotations[rotations_[i].target], rotations_[i].axis, {sines_[i], cosines_[i]});
  }
  const auto translations = clip.translations(frame);
  for (const Step& step : positions_) translations[step.target][step.axis] = row[step.column];
}

}  // namespace retarget
