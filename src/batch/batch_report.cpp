#include "batch/batch_report.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// At most two units: 3 h 20 min, 45 s.
std::string duration_text(double seconds) {
  const long whole = std::lround(seconds);
  if (whole >= 3600) {
    return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
  }
  if (whole >= 60) {
    return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  }
  return std::to_string(whole) + " s";
}

}  // namespace

BatchProgress::BatchProgress(Observer& observer, std::string folder, std::size_t clips,
                             std::uint64_t bytes)
    : observer_(observer), folder_(std::move(folder)), clips_(clips), bytes_(bytes) {}

double BatchProgress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void BatchProgress::finished(const ManifestEntry& entry) {
  const std::lock_guard lock(mutex_);
  bytes_done_ += entry.input.bytes;
  for (const MissingFile& missing : entry.not_written) {
    observer_.warn({{0, 0, "not written: " + missing.reason}}, folder_ + "/" + missing.file);
  }
  if (entry.done) {
    ++done_;
    frames_ += entry.frames;
    return;
  }
  ++failed_;
  if (!entry.error) return;
  observer_.fault(*entry.error);
}

void BatchProgress::skipped(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  ++unchanged_;
  bytes_unchanged_ += bytes;
}

void BatchProgress::show() {
  const std::lock_guard lock(mutex_);
  const double elapsed = seconds();
  std::string text =
      std::to_string(done_ + failed_ + unchanged_) + " / " + count_text(clips_, "clip");
  if (failed_ > 0) text += ", " + std::to_string(failed_) + " failed";
  if (frames_ > 0)
    text += ", " + number_text(static_cast<double>(frames_) / elapsed, 0) + " frames/s";
  if (bytes_done_ > 0) {
    const auto left =
        static_cast<double>(bytes_ - std::min(bytes_, bytes_done_ + bytes_unchanged_));
    text += ", " + duration_text(elapsed * left / static_cast<double>(bytes_done_)) + " left";
  }
  observer_.status(text);
}

std::string BatchProgress::work_text() const {
  const double elapsed = seconds();
  return count_text(frames_, "frame") + " in " + number_text(elapsed, 2) + " s, " +
         number_text(static_cast<double>(frames_) / std::max(elapsed, 1e-3), 0) + " frames/s";
}

namespace {

// Ratio by which a value exceeds its gate; 0 if the value passes.
double ratio_beyond(const GateResult& gate) {
  if (gate.passed || !gate.value) return 0.0;
  const bool too_much = gate.max && !(*gate.value <= *gate.max);
  const double bound = too_much ? *gate.max : gate.min.value_or(0.0);
  const double ratio = *gate.value / bound;
  // A value with the wrong sign has no meaningful ratio.
  if (!(ratio > 0.0) || !std::isfinite(ratio)) return HUGE_VAL;
  return std::max(ratio, 1.0 / ratio);
}

// Quotes a cell where required (RFC 4180).
void add_cell(std::string& row, const std::string& text) {
  if (!row.empty()) row += ',';
  if (text.find_first_of(",\"\r\n") == std::string::npos) {
    row += text;
    return;
  }
  row += '"';
  for (const char letter : text)
    row += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  row += '"';
}

// Adds a text cell. An apostrophe prevents spreadsheets from interpreting it as a formula.
void add_text(std::string& row, const std::string& text) {
  const bool is_formula =
      !text.empty() && std::string_view("=+-@\t\r\n").find(text.front()) != std::string_view::npos;
  add_cell(row, is_formula ? "'" + text : text);
}

std::string row_of(const ManifestEntry& entry) {
  std::string row;
  add_cell(row, entry.done ? "done" : entry.is_left_out() ? "duplicate" : "failed");
  add_text(row, entry.relative);
  add_text(row, entry.robot);
  add_cell(row, entry.done ? std::to_string(entry.frames) : "");
  add_cell(row, entry.done ? number_text(entry.fps) : "");
  const bool timed = entry.done && entry.fps > 0.0;
  add_cell(row, timed ? number_text(std::max(0, entry.frames - 1) / entry.fps) : "");
  const ClipQuality none, &quality = entry.quality ? *entry.quality : none;
  add_cell(row, entry.quality ? std::to_string(quality.missed.size()) : "");
  add_text(row, quality.worst);
  add_cell(row, quality.worst.empty() ? "" : number_text(quality.worst_ratio));
  for (const Metric& metric : quality_metrics()) {
    const auto figure = std::ranges::find_if(
        quality.figures, [&](const auto& item) { return item.first == metric.key; });
    const bool known = figure != quality.figures.end() && !std::isnan(figure->second);
    add_cell(row, known ? number_text(figure->second) : "");
  }
  add_text(row,
           entry.error
               ? describe({entry.error->kind, entry.error->location, entry.error->message, {}, {}})
               : "");
  add_text(row, entry.error ? entry.error->hint : "");
  return row + "\n";
}

namespace fs = std::filesystem;

constexpr std::array kListed = {MotionFormat::kPklGmr, MotionFormat::kPklMimicKit,
                                MotionFormat::kProtoMotions};

// A double-quoted string is the same in YAML and JSON.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool is_listed(const std::string& file) {
  return file.ends_with(".pkl") || file.ends_with(".motion");
}

std::string list_text(const std::string& folder, const std::vector<std::string>& files) {
  std::error_code ignored;
  std::string text =
      fmt::format("root_path: {}\nmotions:\n",
                  quoted(fs::absolute(folder, ignored).lexically_normal().generic_string()));
  for (const std::string& file : files) {
    const std::string name = fs::path(file).filename().generic_string();
    text += fmt::format("  - file: {}\n    weight: 1.0\n    description: {}\n", quoted(file),
                        quoted(name.substr(0, name.find('.'))));
  }
  return text;
}

}  // namespace

ClipQuality clip_quality(const QualityReport& report) {
  ClipQuality quality;
  quality.leg = report.leg;
  for (const MetricValue& value : report.values) {
    quality.figures.emplace_back(value.metric->key, value.value);
  }
  for (const GateResult& gate : report.gates) {
    if (gate.passed) continue;
    quality.missed.push_back(gate.metric);
    quality.missed_gates.push_back(gate);
    const double ratio = ratio_beyond(gate);
    if (quality.worst.empty() || ratio > quality.worst_ratio) {
      quality.worst = gate.metric;
      quality.worst_ratio = ratio;
    }
  }
  return quality;
}

std::vector<const ManifestEntry*> worst_first(std::span<const ManifestEntry> entries) {
  std::vector<const ManifestEntry*> order;
  for (const ManifestEntry& entry : entries) order.push_back(&entry);
  const auto key = [](const ManifestEntry* entry) {
    const bool measured = entry->quality.has_value();
    // Skipped duplicates come last.
    const int place = entry->has_failed() ? 0 : entry->is_left_out() ? 2 : 1;
    return std::tuple(place, measured ? -static_cast<long>(entry->quality->missed.size()) : 0,
                      measured ? -entry->quality->worst_ratio : 0.0, entry->relative, entry->robot);
  };
  std::ranges::sort(order, {}, key);
  return order;
}

std::string summary_csv(std::span<const ManifestEntry> entries) {
  std::string text = "status,clip,robot,frames,fps,duration_s,gates_missed,worst,worst_ratio";
  for (const Metric& metric : quality_metrics()) text.append(",").append(metric.key);
  text += ",message,hint\n";
  for (const ManifestEntry* entry : worst_first(entries)) text += row_of(*entry);
  return text;
}

Result<void> check_motion_list(const SaveOptions& options) {
  const auto listed = std::ranges::count_if(options.formats, [](MotionFormat format) {
    return std::ranges::find(kListed, format) != kListed.end();
  });
  const auto pickles = std::ranges::count_if(
      options.formats, [](MotionFormat format) { return format_ending(format) == ".pkl"; });
  if (listed == 1 && pickles <= 1) return {};
  return usage_failure(RETARGET_OPTION("motion-list") " requires exactly one of the formats pkl-gmr, "
  "pkl-mimickit and protomotions",
                       "choose it with " RETARGET_OPTION("format"));
}

Result<void> write_motion_lists(const std::string& folder, Observer& observer) {
  RETARGET_TRY_ASSIGN(const auto manifest, read_manifest(folder + "/manifest.jsonl"));
  std::map<std::string, std::vector<std::string>> files;  // By the folder of the list.
  for (const ManifestEntry& entry : latest_entries(manifest.entries)) {
    if (!entry.done) continue;
    for (const FileRecord& output : entry.outputs) {
      if (!is_listed(output.file)) continue;
      const std::string own = entry.robot + "/";
      const bool apart = output.file.starts_with(own);
      files[apart ? folder + "/" + entry.robot : folder].push_back(
          apart ? output.file.substr(own.size()) : output.file);
    }
  }
  for (const auto& [place, names] : files) {
    const std::string path = place + "/motions.yaml";
    RETARGET_TRY(write_file(path, list_text(place, names)));
    observer.line("wrote", path + ": " + count_text(names.size(), "motion"));
  }
  return {};
}

}  // namespace retarget
