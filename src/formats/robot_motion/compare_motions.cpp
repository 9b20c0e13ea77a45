#include "retarget/compare.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/containers/file_kind.h"
#include "formats/containers/npy.h"
#include "formats/containers/npz.h"
#include "formats/containers/pickle.h"
#include "motion/clip.h"
#include "retarget/csv_table.h"
#include "retarget/error.h"
#include "retarget/file.h"
#include "retarget/robot.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr double kUnitLength = 0.01;

double difference_of(double a, double b) {
  const double found = std::abs(a - b);
  return std::isnan(found) ? std::numeric_limits<double>::infinity() : found;
}

// Decimal numbers that differ by the tolerance may differ by slightly more in binary.
bool is_beyond(double found, double tolerance, double value) {
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  return found > tolerance * (1.0 + 1e-6) + kRounding * std::abs(value);
}

// Turns arrays with one row per frame into columns and keeps all others separately.
class TableBuilder {
 public:
  void add(const std::string& name, const NpyArray& array) {
    if (!array.is_number() || array.element_count() == 0) return;
    if (array.shape.empty()) {
      numbers_.emplace_back(name, array.numbers());
    } else {
      arrays_.emplace_back(name, &array);
    }
  }
  void add(const std::string& name, double number) {
    numbers_.emplace_back(name, std::vector<double>{number});
  }

  // The number of frames is the most common number of rows.
  [[nodiscard]] MotionTable build() const {
    std::map<std::size_t, int> votes;
    for (const auto& [name, array] : arrays_) {
      if (array->shape.size() > 1) ++votes[array->shape[0]];
    }
    MotionTable table;
    for (const auto& [frames, count] : votes) {
      if (table.frames == 0 || count > votes[table.frames]) table.frames = frames;
    }
    std::vector<std::vector<double>> columns;
    for (const auto& [name, array] : arrays_) {
      if (array->shape[0] == table.frames) {
        add_columns(name, *array, table, columns);
      } else {
        table.others.emplace_back(name, array->numbers());
      }
    }
    table.others.insert(table.others.end(), numbers_.begin(), numbers_.end());
    for (std::size_t frame = 0; frame < table.frames; ++frame) {
      for (const auto& column : columns) table.values.push_back(column[frame]);
    }
    return table;
  }

 private:
  static void add_columns(const std::string& name, const NpyArray& array, MotionTable& table,
                          std::vector<std::vector<double>>& columns) {
    const std::vector<double> values = array.numbers();
    const std::size_t width = values.size() / table.frames;
    const bool quaternions = array.shape.back() == 4 && (name.find("quat") != std::string::npos ||
                                                         name.find("rot") != std::string::npos);
    for (std::size_t i = 0; i < width; ++i) {
      if (quaternions && i % 4 == 0) table.quaternions.push_back(table.columns.size());
      std::string index;
      std::size_t rest = i;
      for (std::size_t d = array.shape.size(); d-- > 1;) {
        index = fmt::format("{}{}{}", rest % array.shape[d], index.empty() ? "" : ",", index);
        rest /= array.shape[d];
      }
      table.columns.push_back(index.empty() ? name : fmt::format("{}[{}]", name, index));
      std::vector<double>& column = columns.emplace_back();
      for (std::size_t frame = 0; frame < table.frames; ++frame) {
        column.push_back(values[frame * width + i]);
      }
    }
  }

  std::vector<std::pair<std::string, const NpyArray*>> arrays_;
  std::vector<std::pair<std::string, std::vector<double>>> numbers_;
};

bool unit_quaternions(const CsvTable& table, std::size_t first) {
  if (first + 4 > table.columns) return false;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    double square = 0.0;
    for (std::size_t k = 0; k < 4; ++k) square += table.row(i)[first + k] * table.row(i)[first + k];
    if (!(std::abs(std::sqrt(square) - 1.0) <= kUnitLength)) return false;
  }
  return true;
}

MotionTable table_of_csv(CsvTable csv) {
  MotionTable table;
  table.frames = csv.rows();
  table.columns = csv.header;
  for (std::size_t i = table.columns.size(); i < csv.columns; ++i) {
    table.columns.push_back("column " + std::to_string(i + 1));
  }
  for (const std::size_t first : {std::size_t{3}, std::size_t{4}}) {
    if (!unit_quaternions(csv, first)) continue;
    table.quaternions.push_back(first);
    break;
  }
  table.values = std::move(csv.values);
  return table;
}

Result<MotionTable> table_of_npz(std::string_view bytes, const std::string& file) {
  TRY_ASSIGN(const auto npz, NpzFile::open(bytes, file));
  std::vector<NpyArray> arrays;
  for (const std::string& name : npz.names()) {
    TRY_ASSIGN(auto array, npz.read(name));
    arrays.push_back(std::move(array));
  }
  TableBuilder builder;
  for (std::size_t i = 0; i < arrays.size(); ++i) builder.add(npz.names()[i], arrays[i]);
  return builder.build();
}

void add_dictionary(const PickleDocument& document, const PickleNode& dictionary,
                    const std::string& prefix, int depth, TableBuilder& builder) {
  if (dictionary.kind != PickleNode::Kind::kDict) return;
  // A pickle may refer to one member many times; visit it once.
  std::set<const PickleNode*> seen;
  for (std::size_t i = 0; i + 1 < dictionary.items.size(); i += 2) {
    const PickleNode &key = document.at(dictionary.items[i]),
                     &member = document.at(dictionary.items[i + 1]);
    if (key.kind != PickleNode::Kind::kText || !seen.insert(&member).second) continue;
    const std::string name = prefix + std::string(key.text);
    if (member.kind == PickleNode::Kind::kArray) {
      builder.add(name, document.array(member));
    } else if (const auto number = document.number(member)) {
      builder.add(name, *number);
    } else if (depth == 0) {
      // PBHC nests its motions one level deeper.
      add_dictionary(document, member, name + "/", 1, builder);
    }
  }
}

}  // namespace

MotionTable motion_table(const RobotClip& clip) {
  const Robot& robot = clip.robot();
  MotionTable table;
  table.frames = static_cast<std::size_t>(clip.frame_count());
  table.columns = {"root_x", "root_y", "root_z", "root_qx", "root_qy", "root_qz", "root_qw"};
  table.quaternions = {3};
  for (const int joint : robot.output_joints()) {
    table.columns.push_back(robot.joints()[joint].name);
  }
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    const auto qpos = clip.qpos(frame);
    for (const int address : {0, 1, 2, 4, 5, 6, 3}) table.values.push_back(qpos[address]);
    for (const int joint : robot.output_joints()) {
      table.values.push_back(qpos[robot.joints()[joint].qpos_address]);
    }
  }
  return table;
}

namespace {

Result<MotionTable> any_table(std::string_view bytes, const std::string& file) {
  const FileKind kind = file_type(bytes).kind;
  if (kind == FileKind::kNpz || kind == FileKind::kTorch) return table_of_npz(bytes, file);
  if (kind == FileKind::kPickle || kind == FileKind::kGzip) {
    TRY_ASSIGN(const auto document, read_pickle(bytes, file));
    TableBuilder builder;
    add_dictionary(document, document.root(), "", 0, builder);
    return builder.build();
  }
  TRY_ASSIGN(auto csv, read_csv_table(bytes, file));
  return table_of_csv(std::move(csv));
}

// Compares the other data by name.
void compare_others(const MotionTable& a, const MotionTable& b, double tolerance,
                    MotionDifference& difference) {
  std::map<std::string, std::pair<std::vector<double>, std::vector<double>>> by_name;
  for (const auto& [name, values] : a.others) by_name[name].first = values;
  for (const auto& [name, values] : b.others) by_name[name].second = values;
  for (const auto& [name, values] : by_name) {
    const auto& [of_a, of_b] = values;
    ColumnDifference found;
    found.column = name;
    if (of_a.size() != of_b.size()) found.largest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(of_a.size(), of_b.size()); ++i) {
      found.largest = std::max(found.largest, difference_of(of_a[i], of_b[i]));
    }
    difference.largest = std::max(difference.largest, found.largest);
    if (!is_beyond(found.largest, tolerance, 0.0)) continue;
    found.frames_beyond = 1;
    difference.columns.push_back(std::move(found));
  }
}

}  // namespace

Result<MotionTable> parse_motion_table(std::string_view bytes, const std::string& file) {
  auto table = any_table(bytes, file);
  if (table && (table->columns.empty() || table->frames == 0)) {
    return input_failure(file, "the file has no array with one row per frame");
  }
  return table;
}

Result<MotionTable> load_motion_table(const std::string& path, std::size_t max_bytes) {
  TRY_ASSIGN(const auto content, read_file(path, ErrorKind::kInput, max_bytes, kLargeFileHint));
  return parse_motion_table(content.view(), path);
}

Result<MotionDifference> compare_motions(const MotionTable& a, const MotionTable& b,
                                         double tolerance) {
  const std::size_t width = a.columns.size();
  if (width != b.columns.size()) {
    return input_failure("",
                         "one motion has " + std::to_string(width) + " columns, the other " +
                             std::to_string(b.columns.size()),
                         OPTION("robot") " allows a comparison of different formats");
  }
  for (std::size_t i = 0; i < width; ++i) {
    if (a.columns[i] == b.columns[i]) continue;
    return input_failure("",
                         "column " + std::to_string(i + 1) + " is \"" + a.columns[i] +
                             "\" in one motion and \"" + b.columns[i] + "\" in the other",
                         OPTION("robot") " allows a comparison of different formats");
  }
  MotionDifference difference;
  difference.frames_a = a.frames;
  difference.frames_b = b.frames;
  difference.column_count = width;
  std::vector<ColumnDifference> columns(width);
  std::vector<double> sign(width);
  for (std::size_t frame = 0; frame < std::min(a.frames, b.frames); ++frame) {
    const double* of_a = a.values.data() + frame * width;
    const double* of_b = b.values.data() + frame * width;
    std::ranges::fill(sign, 1.0);
    for (const std::size_t first : a.quaternions) {
      double dot = 0.0;
      for (std::size_t k = first; k < first + 4; ++k) dot += of_a[k] * of_b[k];
      if (dot < 0.0) std::fill_n(sign.begin() + static_cast<std::ptrdiff_t>(first), 4, -1.0);
    }
    for (std::size_t i = 0; i < width; ++i) {
      const double found = difference_of(of_a[i], sign[i] * of_b[i]);
      ColumnDifference& column = columns[i];
      if (found > column.largest) {
        column.largest = found;
        column.largest_frame = frame;
      }
      if (is_beyond(found, tolerance, of_a[i]) && column.frames_beyond++ == 0) {
        column.first_frame = frame;
      }
    }
  }
  for (std::size_t i = 0; i < width; ++i) {
    difference.largest = std::max(difference.largest, columns[i].largest);
    columns[i].column = a.columns[i];
    if (columns[i].frames_beyond > 0) difference.columns.push_back(columns[i]);
  }
  compare_others(a, b, tolerance, difference);
  std::ranges::stable_sort(difference.columns, std::greater<>(), &ColumnDifference::largest);
  return difference;
}

namespace {

constexpr std::size_t kColumnsShown = 5;

// Enough digits for a difference of any size.
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
