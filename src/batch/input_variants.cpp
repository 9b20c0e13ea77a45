#include "batch/input_variants.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "retarget/csv_table.h"
#include "retarget/file.h"
#include "retarget/option_name.h"
#include "retarget/os.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Enough for millions of rows; stops reading from an endless pipe.
constexpr std::size_t kMaxTableBytes = std::size_t{256} << 20U;
constexpr double kMaxEnd = 1e9;

enum Column : std::size_t { kFile, kStart, kEnd, kName };
constexpr std::array<std::string_view, 4> kColumns = {"file", "start", "end", "name"};

Failure row_failure(const std::string& path, std::size_t line, std::string message,
                    std::string hint = {}) {
  return failure({ErrorKind::kInput, {path, line, 0}, std::move(message), {}, std::move(hint)});
}

// Parses seconds, or `f` and an integer. Returns nothing for other text.
std::optional<double> end_value(const std::string& text) {
  const bool is_frame = text.starts_with('f');
  if (is_frame) {
    const auto frame = parse_number<int>(std::string_view(text).substr(1));
    return frame && *frame >= 0 ? std::optional<double>(*frame) : std::nullopt;
  }
  const auto seconds = parse_number<double>(text);
  return seconds && *seconds >= 0.0 && *seconds <= kMaxEnd ? seconds : std::nullopt;
}

class ClipTableReader {
 public:
  explicit ClipTableReader(const std::string& path) : path_(path) {}

  Result<void> take(std::string_view text) {
    ++line_;
    split_cells(text, cells_);
    if (!begun_ && is_header()) return take_header();
    begun_ = true;
    return take_row();
  }

  [[nodiscard]] std::vector<ClipRow> rows() && { return std::move(rows_); }

  std::size_t line_ = 0;

 private:
  [[nodiscard]] bool is_header() const {
    return std::ranges::any_of(
        cells_, [](const CsvCell& cell) { return lower_case(std::string(cell.text)) == "file"; });
  }

  Result<void> take_header() {
    begun_ = true;
    places_.fill(std::nullopt);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const std::string name = lower_case(std::string(cells_[i].text));
      const auto known = std::ranges::find(kColumns, name);
      if (known != kColumns.end()) {
        places_[static_cast<std::size_t>(known - kColumns.begin())] = i;
      }
    }
    if (places_[kStart] || places_[kEnd]) return {};
    return row_failure(path_, line_, "the header has no column \"start\" or \"end\"",
                       "file,start,end,name");
  }

  [[nodiscard]] std::string cell(Column column) const {
    const auto place = places_[column];
    return place && *place < cells_.size() ? std::string(cells_[*place].text) : std::string();
  }

  Result<void> take_row() {
    ClipRow row{cell(kFile), {}, cell(kName), line_};
    if (row.file.empty()) {
      return row_failure(path_, line_, "the row has no file name",
                         "a row has the form file,start,end,name");
    }
    const std::string start = cell(kStart), end = cell(kEnd);
    const auto first = end_value(start), last = end_value(end);
    for (const auto& [text, value] : {std::pair(start, first), std::pair(end, last)}) {
      if (text.empty() || value) continue;
      return row_failure(path_, line_,
                         fmt::format("expected a time or a frame, found \"{}\"", text),
                         "12.3 means seconds, f120 a frame");
    }
    if (first && last && start.starts_with('f') != end.starts_with('f')) {
      return row_failure(path_, line_, fmt::format("{} and {} mix a time and a frame", start, end),
                         "give both in seconds (12.3) or both in frames (f120)");
    }
    if (first && last && *first >= *last) {
      return row_failure(path_, line_, fmt::format("the part from {} to {} is empty", start, end));
    }
    if (!row.name.empty() && !is_plain_path(row.name)) {
      return row_failure(path_, line_, fmt::format("\"{}\" is not a valid clip name", row.name),
                         "a name must be a path below the output folder, without extension");
    }
    row.part = part_text(start, end);
    rows_.push_back(std::move(row));
    return {};
  }

  const std::string& path_;
  std::vector<CsvCell> cells_;
  std::array<std::optional<std::size_t>, 4> places_ = {0, 1, 2, 3};
  bool begun_ = false;
  std::vector<ClipRow> rows_;
};

// Inputs by the names that a row may use; null for ambiguous names.
class InputNames {
 public:
  explicit InputNames(const std::vector<BatchInput>& inputs) {
    for (const BatchInput& input : inputs) {
      by_name_[input.relative] = &input;
      by_name_.emplace(fs::path(input.path).lexically_normal().generic_string(), &input);
    }
    for (const BatchInput& input : inputs) {
      const std::string name = fs::path(input.relative).filename().generic_string();
      const auto [at, is_new] = by_last_part_.emplace(name, &input);
      if (!is_new) at->second = nullptr;
    }
  }

  [[nodiscard]] const BatchInput* find(const std::string& file) const {
    for (const std::string& name : {file, fs::path(file).lexically_normal().generic_string()}) {
      const auto found = by_name_.find(name);
      if (found != by_name_.end()) return found->second;
    }
    const auto last = by_last_part_.find(file);
    return last == by_last_part_.end() ? nullptr : last->second;
  }

  [[nodiscard]] std::string suggestion(const std::string& file) const {
    std::vector<std::string> known;
    for (const auto& [name, input] : by_name_) known.push_back(name);
    return did_you_mean(file, known);
  }

 private:
  std::map<std::string, const BatchInput*> by_name_, by_last_part_;
};

// Places the part next to its file and keeps the extension, which determines the kind of file.
std::string part_name(const BatchInput& input, const std::string& name) {
  const fs::path file(input.relative);
  return (file.parent_path() / (name + file.extension().generic_string()))
      .lexically_normal()
      .generic_string();
}

}  // namespace

Result<std::vector<ClipRow>> read_clip_table(const std::string& path) {
  RETARGET_TRY_ASSIGN(const auto content, read_file(path, ErrorKind::kInput, kMaxTableBytes));
  std::string_view text = without_byte_order_mark(content.view());
  ClipTableReader reader(path);
  while (!text.empty()) {
    std::string_view line = take_until(text, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.find_first_not_of(" \t,;") == std::string_view::npos || line.starts_with('#')) {
      ++reader.line_;
      continue;
    }
    RETARGET_TRY(reader.take(line));
  }
  std::vector<ClipRow> rows = std::move(reader).rows();
  if (rows.empty()) {
    return input_failure(path, "the table of clips has no rows",
                         "a row has the form file,start,end,name");
  }
  return rows;
}

Result<std::vector<std::string>> files_of_rows(const std::vector<ClipRow>& rows,
                                               const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  std::set<std::string> files;
  for (const ClipRow& row : rows) {
    const std::string file = (folder / row.file).generic_string();
    if (!os::status_of(file)) {
      return row_failure(path, row.line, "there is no file \"" + file + "\"",
                         "give its path from the folder of the table, or give the folder of clips");
    }
    files.insert(file);
  }
  return std::vector<std::string>(files.begin(), files.end());
}

Result<std::vector<BatchInput>> parts_of(const std::vector<BatchInput>& inputs,
                                         const std::vector<ClipRow>& rows,
                                         const std::string& path) {
  const InputNames names(inputs);
  std::map<std::string, int> parts;            // Number of parts per file so far.
  std::map<std::string, std::size_t> line_of;  // Line of each clip name.
  std::vector<BatchInput> result;
  result.reserve(rows.size());
  for (const ClipRow& row : rows) {
    const BatchInput* input = names.find(row.file);
    if (input == nullptr) {
      return row_failure(path, row.line,
                         fmt::format("\"{}\" matches no motion, or several{}", row.file,
                                     names.suggestion(row.file)),
                         "give its path below the folder of clips: a/walk.bvh");
    }
    const int number = ++parts[input->relative];
    const std::string own = fs::path(input->relative).stem().generic_string();
    BatchInput part = *input;
    part.variant = {input->relative, row.part, {}};
    part.relative = part_name(
        *input, row.name.empty() ? fmt::format("{}_{}", own, number) : output_stem(row.name));
    const auto [at, is_new] = line_of.emplace(part.relative, row.line);
    if (!is_new) {
      return row_failure(path, row.line,
                         fmt::format("the clip \"{}\" is already defined in line {}",
                                     output_stem(part.relative), at->second),
                         "give every row a unique name");
    }
    result.push_back(std::move(part));
  }
  return result;
}

std::vector<BatchInput> with_mirror_images(std::vector<BatchInput> inputs) {
  const std::size_t count = inputs.size();
  inputs.reserve(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    BatchInput image = inputs[i];
    if (image.variant.source.empty()) image.variant.source = image.relative;
    image.variant.mirror_of = image.relative;
    image.relative = mirrored_name(image.relative);
    inputs.push_back(std::move(image));
  }
  return inputs;
}

namespace {

// Pseudo-random numbers that are equal on every machine: SplitMix64 (Steele, Lea and Flood, 2014),
// seeded by a hash of a text (FNV-1a).
class ChangeDraw {
 public:
  explicit ChangeDraw(std::string_view text) {
    for (const char letter : text) {
      state_ = (state_ ^ static_cast<unsigned char>(letter)) * 0x100000001b3ULL;
    }
  }

  // A number between two others, with three digits.
  std::string between(double low, double high) {
    state_ += 0x9e3779b97f4a7c15ULL;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ (mixed >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94d049bb133111ebULL;
    mixed ^= mixed >> 31U;
    const double share = static_cast<double>(mixed >> 11U) * 0x1p-53;
    return fmt::format("{:.3f}", low + share * (high - low));
  }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

std::string scaled(double value, double least, double most, ChangeDraw& draw, double low,
                   double high) {
  const double factor = parse_number<double>(draw.between(low, high)).value_or(1.0);
  return fmt::format("{:.3f}", std::clamp(factor * value, least, most));
}

// SolveOptions::terrain with other sizes, within the range that it accepts.
std::string varied_terrain(const std::string& terrain, ChangeDraw& draw) {
  constexpr std::string_view kStairs = "stairs:", kSlope = "slope:";
  if (terrain.starts_with(kSlope)) {
    const double degrees = parse_number<double>(terrain.substr(kSlope.size())).value_or(1.0);
    return std::string(kSlope) + scaled(degrees, 0.5, 30.0, draw, 0.5, 1.5);
  }
  const std::size_t by = terrain.find('x');
  const std::size_t end = std::min(terrain.find('x', by + 1), terrain.size());
  const auto number = [&](std::size_t from, std::size_t to) {
    return parse_number<double>(std::string_view(terrain).substr(from, to - from)).value_or(0.1);
  };
  const double rise = number(kStairs.size(), by), tread = number(by + 1, end);
  const std::string changed_rise = scaled(rise, 0.005, 0.5, draw, 0.75, 1.25);
  const std::string changed_tread = scaled(tread, 0.1, 2.0, draw, 0.75, 1.25);
  return std::string(kStairs) + changed_rise + "x" + changed_tread + terrain.substr(end);
}

std::string drawn_changes(const SolveOptions& options, ChangeDraw draw) {
  if (!options.terrain.empty()) return "terrain=" + varied_terrain(options.terrain, draw);
  if (options.object_tracks.empty()) return "terrain-scale=z=" + draw.between(0.8, 1.2);
  const std::string x = draw.between(-0.1, 0.1), y = draw.between(-0.1, 0.1);
  return fmt::format("object-shift={},{},0 object-scale={}", x, y, draw.between(0.85, 1.15));
}

void apply_change(std::string_view name, const std::string& value, SolveOptions& options) {
  if (name == "terrain") options.terrain = value;
  if (name == "terrain-scale") options.terrain_scale = value;
  if (name == "object-shift") options.object_shift = value;
  if (name == "object-scale") {
    options.object_scale = parse_number<double>(value).value_or(options.object_scale);
  }
}

}  // namespace

Result<std::vector<BatchInput>> with_variations(std::vector<BatchInput> inputs, int count, int seed,
                                                const SolveOptions& options) {
  if (options.scene.empty() && options.terrain.empty()) {
    return usage_failure(RETARGET_OPTION("variants") " requires " RETARGET_OPTION(
                             "scene") " or " RETARGET_OPTION("terrain"),
                         "variations differ in their scenes");
  }
  const std::size_t originals = inputs.size();
  inputs.reserve(originals * (1 + static_cast<std::size_t>(count)));
  for (std::size_t i = 0; i < originals; ++i) {
    for (int number = 1; number <= count; ++number) {
      BatchInput varied = inputs[i];
      if (varied.variant.source.empty()) varied.variant.source = varied.relative;
      varied.variant.varied_of = varied.relative;
      varied.variant.changes = drawn_changes(
          options, ChangeDraw(fmt::format("{}\n{}\n{}", seed, varied.relative, number)));
      varied.relative = suffixed_name(varied.relative, fmt::format("_v{}", number));
      inputs.push_back(std::move(varied));
    }
  }
  return inputs;
}

void apply_changes(const std::string& changes, SolveOptions& options) {
  const std::string_view view = changes;
  for (std::size_t begin = 0; begin < view.size();) {
    const std::size_t end = std::min(view.find(' ', begin), view.size());
    const std::string_view change = view.substr(begin, end - begin);
    const std::size_t equals = std::min(change.find('='), change.size());
    const std::string_view value = change.substr(std::min(equals + 1, change.size()));
    apply_change(change.substr(0, equals), std::string(value), options);
    begin = end + 1;
  }
}

}  // namespace retarget
