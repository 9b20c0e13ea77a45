#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "batch/manifest.h"
#include "retarget/bytes.h"
#include "retarget/json.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr std::int64_t kMsPerSecond = 1000;

// Formats milliseconds since 1970 as 2026-01-31T12:00:00.000Z.
std::string utc_text(std::int64_t ms) {
  const std::chrono::sys_time<std::chrono::milliseconds> moment{std::chrono::milliseconds(ms)};
  const auto day = std::chrono::floor<std::chrono::days>(moment);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(moment - day);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     time.hours().count(), time.minutes().count(), time.seconds().count(),
                     time.subseconds().count());
}

// Parses the format of utc_text, with or without milliseconds. Returns nothing for other text.
std::optional<std::int64_t> ms_of(const std::string& text) {
  constexpr std::string_view kForm = "0000-00-00T00:00:00";
  if (text.size() <= kForm.size() || !text.ends_with('Z')) return std::nullopt;
  std::array<int, 6> parts{};  // Year, month, day, hour, minute, second.
  std::size_t part = 0;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    if (kForm[i] != '0') {
      if (text[i] != kForm[i]) return std::nullopt;
      ++part;
    } else if (text[i] < '0' || text[i] > '9') {
      return std::nullopt;
    } else {
      parts[part] = 10 * parts[part] + (text[i] - '0');
    }
  }
  const std::chrono::year_month_day date{std::chrono::year(parts[0]),
                                         std::chrono::month(static_cast<unsigned>(parts[1])),
                                         std::chrono::day(static_cast<unsigned>(parts[2]))};
  constexpr int kHours = 24, kMinutes = 60, kSeconds = 61;  // The last one is a leap second.
  if (!date.ok() || parts[3] >= kHours || parts[4] >= kMinutes || parts[5] >= kSeconds) {
    return std::nullopt;
  }
  const auto moment = std::chrono::sys_days(date) + std::chrono::hours(parts[3]) +
                      std::chrono::minutes(parts[4]) + std::chrono::seconds(parts[5]);
  const std::string_view rest = std::string_view(text).substr(kForm.size());
  const bool whole = rest == "Z";
  if (!whole && !rest.starts_with('.')) return std::nullopt;
  const auto ms =
      whole ? std::optional(0U) : parse_number<unsigned>(rest.substr(1, rest.size() - 2));
  if (!ms || *ms >= kMsPerSecond) return std::nullopt;
  return std::chrono::duration_cast<std::chrono::milliseconds>(moment.time_since_epoch()).count() +
         *ms;
}

}  // namespace

std::string finished_after(std::int64_t now_ms, const std::string& earlier) {
  const auto known = ms_of(earlier);
  return utc_text(known && *known >= now_ms ? *known + 1 : now_ms);
}

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const FileRecord& record) {
  Json json;
  put_name(json, "file", record.file);
  json["bytes"] = record.bytes;
  json["modified_ns"] = record.modified_ns;
  json["hash"] = record.hash;
  return json;
}

Json json_of(const Error& error, int exit_code) {
  Json json;
  put_name(json, "file", error.location.file);
  if (error.location.line > 0) json["line"] = error.location.line;
  if (error.location.column > 0) json["column"] = error.location.column;
  json["message"] = valid_utf8(full_message(error));
  if (!error.hint.empty()) json["hint"] = valid_utf8(error.hint);
  json["exit_code"] = exit_code;
  return json;
}

Json json_of(const ClipQuality& quality) {
  Json json;
  json["figures"] = Json::object();
  for (const auto& [key, value] : quality.figures) json["figures"][key] = value;
  json["gates_missed"] = quality.missed;
  json["worst"] = quality.worst.empty() ? Json() : Json(quality.worst);
  // JSON does not support infinity.
  if (!quality.worst.empty() && std::isfinite(quality.worst_ratio)) {
    json["worst_ratio"] = quality.worst_ratio;
  }
  if (quality.leg) json["leg_m"] = *quality.leg;
  for (const GateResult& gate : quality.missed_gates) {
    Json& bounds = json["bounds"][gate.metric];
    if (gate.min) bounds["min"] = *gate.min;
    if (gate.max) bounds["max"] = *gate.max;
  }
  return json;
}

Json json_of(const RepeatedClip& repeated) {
  Json json;
  put_name(json, "of", repeated.of);
  json["kind"] = repeated.mirrored ? "mirrored" : "same";
  json["distance_deg"] = repeated.distance;
  return json;
}

// Writes a list, unless it is empty.
void put_texts(Json& json, const char* key, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) json[key].push_back(valid_utf8(text));
}

// Writes how the clip relates to its file; nothing for a whole file.
void put_variant(Json& json, const ClipVariant& variant) {
  if (!variant.source.empty()) put_name(json, "source", variant.source);
  if (!variant.part.empty()) json["part"] = variant.part;
  if (variant.is_mirrored()) put_name(json, "mirror_of", variant.mirror_of);
  if (variant.is_varied()) put_name(json, "varied_of", variant.varied_of);
  if (variant.is_varied()) json["changes"] = variant.changes;
}

// Reads optional members; members that are missing or of another type keep their defaults.
class EntryReader {
 public:
  explicit EntryReader(const Json& json) : json_(json) {}

  [[nodiscard]] const Json* member(const std::string& key) const {
    const auto at = json_.is_object() ? json_.find(key) : json_.end();
    return json_.is_object() && at != json_.end() ? &*at : nullptr;
  }
  template <typename T>
  void read(const std::string& key, T& value) const {
    const Json* json = member(key);
    if (json == nullptr) return;
    if (auto known = value_from<T>(*json)) value = *std::move(known);
  }
  void name(const std::string& key, std::string& value) const {
    if (member(key) != nullptr) value = name_from(json_, key);
  }
  // Reads the strings of a list.
  void texts(const std::string& key, std::vector<std::string>& values) const {
    const Json* json = member(key);
    if (json == nullptr || !json->is_array()) return;
    for (const Json& each : *json) {
      if (auto text = value_from<std::string>(each)) values.push_back(*std::move(text));
    }
  }

 private:
  const Json& json_;
};

FileRecord file_record(const Json& json) {
  const EntryReader reader(json);
  FileRecord record;
  reader.name("file", record.file);
  reader.read("bytes", record.bytes);
  reader.read("modified_ns", record.modified_ns);
  reader.read("hash", record.hash);
  return record;
}

void read_error(const Json& json, ManifestEntry& entry) {
  const EntryReader reader(json);
  Error& error = entry.error.emplace();
  reader.name("file", error.location.file);
  reader.read("line", error.location.line);
  reader.read("column", error.location.column);
  reader.read("message", error.message);
  reader.read("hint", error.hint);
  reader.read("exit_code", entry.exit_code);
}

// Reads the bounds of missed gates; `figures` has their values.
void read_bounds(const Json& json, ClipQuality& quality) {
  const EntryReader reader(json);
  for (const std::string& key : quality.missed) {
    const Json* bounds = reader.member(key);
    const auto figure =
        std::ranges::find(quality.figures, key, [](const auto& each) { return each.first; });
    if (bounds == nullptr) continue;
    const EntryReader bound(*bounds);
    GateResult gate{key, std::nullopt, std::nullopt, std::nullopt, false};
    if (figure != quality.figures.end()) gate.value = figure->second;
    if (double min = 0.0; bound.member("min") != nullptr) {
      bound.read("min", min);
      gate.min = min;
    }
    if (double max = 0.0; bound.member("max") != nullptr) {
      bound.read("max", max);
      gate.max = max;
    }
    if (gate.min || gate.max) quality.missed_gates.push_back(std::move(gate));
  }
}

ClipQuality clip_quality(const Json& json) {
  const EntryReader reader(json);
  ClipQuality quality;
  if (const Json* figures = reader.member("figures"); figures != nullptr && figures->is_object()) {
    for (const auto& [key, value] : figures->items()) {
      // JSON does not support NaN.
      if (value.is_null()) {
        quality.figures.emplace_back(key, std::numeric_limits<double>::quiet_NaN());
      }
      if (value.is_number()) quality.figures.emplace_back(key, value.get<double>());
    }
  }
  reader.texts("gates_missed", quality.missed);
  reader.read("worst", quality.worst);
  quality.worst_ratio = quality.worst.empty() ? 0.0 : HUGE_VAL;
  reader.read("worst_ratio", quality.worst_ratio);
  if (double leg = 0.0; reader.member("leg_m") != nullptr) {
    reader.read("leg_m", leg);
    if (leg > 0.0) quality.leg = leg;
  }
  if (const Json* bounds = reader.member("bounds")) read_bounds(*bounds, quality);
  return quality;
}

// Reads how the clip relates to its file. An invalid part counts as missing.
void read_variant(const EntryReader& reader, ManifestEntry& entry) {
  reader.name("source", entry.variant.source);
  reader.read("part", entry.variant.part);
  reader.name("mirror_of", entry.variant.mirror_of);
  reader.name("varied_of", entry.variant.varied_of);
  reader.read("changes", entry.variant.changes);
  if (const Json* repeated = reader.member("repeats")) {
    const EntryReader of(*repeated);
    RepeatedClip& clip = entry.repeated.emplace();
    of.name("of", clip.of);
    std::string kind;
    of.read("kind", kind);
    clip.mirrored = kind == "mirrored";
    of.read("distance_deg", clip.distance);
  }
  std::string signature;
  reader.read("signature", signature);
  entry.signature = bytes_from_base64(signature).value_or(std::string());
}

}  // namespace

std::string manifest_line(const ManifestEntry& entry) {
  Json json;
  put_name(json, "relative", entry.relative);
  put_name(json, "robot", entry.robot);
  json["status"] = entry.done ? "done" : entry.is_left_out() ? "duplicate" : "failed";
  put_variant(json, entry.variant);
  if (entry.error) json["error"] = json_of(*entry.error, entry.exit_code);
  json["input"] = json_of(entry.input);
  json["options_hash"] = entry.options_hash;
  json["outputs"] = Json::array();
  for (const FileRecord& output : entry.outputs) json["outputs"].push_back(json_of(output));
  for (const MissingFile& missing : entry.not_written) {
    Json each;
    put_name(each, "file", missing.file);
    each["reason"] = valid_utf8(missing.reason);
    json["not_written"].push_back(std::move(each));
  }
  json["frames"] = entry.frames;
  json["fps"] = entry.fps;
  json["seconds"] = entry.seconds;
  json["finished"] = entry.finished;
  if (!entry.taken_as.empty()) json["taken_as"] = valid_utf8(entry.taken_as);
  if (!entry.config.empty()) json["mapping"] = valid_utf8(entry.config);
  put_texts(json, "warnings", entry.warnings);
  put_texts(json, "notes", entry.notes);
  if (entry.quality) json["quality"] = json_of(*entry.quality);
  if (entry.repeated) json["repeats"] = json_of(*entry.repeated);
  if (!entry.signature.empty()) json["signature"] = base64_text(entry.signature);
  return json.dump() + "\n";
}

std::optional<ManifestEntry> parse_manifest_line(std::string_view line) {
  const auto json = parse_json(line, "");
  if (!json || !json->is_object()) return std::nullopt;
  const EntryReader reader(*json);
  ManifestEntry entry;
  reader.name("relative", entry.relative);
  reader.name("robot", entry.robot);
  std::string status;
  reader.read("status", status);
  read_variant(reader, entry);
  const bool known = status == "done" || status == "failed" ||
                     (status == "duplicate" && entry.repeated.has_value());
  if (entry.relative.empty() || !known) return std::nullopt;
  entry.done = status == "done";
  if (status == "failed") entry.repeated.reset();
  if (const Json* error = reader.member("error")) read_error(*error, entry);
  if (const Json* input = reader.member("input")) entry.input = file_record(*input);
  reader.read("options_hash", entry.options_hash);
  if (const Json* outputs = reader.member("outputs"); outputs != nullptr && outputs->is_array()) {
    for (const Json& output : *outputs) entry.outputs.push_back(file_record(output));
  }
  if (const Json* missing = reader.member("not_written"); missing && missing->is_array()) {
    for (const Json& each : *missing) {
      const EntryReader of(each);
      MissingFile& file = entry.not_written.emplace_back();
      of.name("file", file.file);
      of.read("reason", file.reason);
    }
  }
  reader.read("frames", entry.frames);
  reader.read("fps", entry.fps);
  reader.read("seconds", entry.seconds);
  reader.read("finished", entry.finished);
  reader.read("taken_as", entry.taken_as);
  reader.read("mapping", entry.config);
  reader.texts("warnings", entry.warnings);
  reader.texts("notes", entry.notes);
  if (const Json* quality = reader.member("quality")) entry.quality = clip_quality(*quality);
  return entry;
}

}  // namespace retarget
