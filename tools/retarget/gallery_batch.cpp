#include "gallery_batch.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "app/provenance/hash.h"
#include "base/json.h"
#include "batch/resume.h"
#include "retarget/file.h"
#include "retarget/option_table.h"
#include "retarget/try.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// Options of a batch that describe its sources and how its motions are measured.
constexpr std::array<std::string_view, 30> kOfSources = {"lenient",
                                                         "root",
                                                         "take",
                                                         "source-fps",
                                                         "partial",
                                                         "rest",
                                                         "tpose-frame",
                                                         "unit",
                                                         "up",
                                                         "forward",
                                                         "height",
                                                         "start",
                                                         "end",
                                                         "frames",
                                                         "lead-in",
                                                         "base",
                                                         "scale",
                                                         "limits",
                                                         "method",
                                                         "normalize-start",
                                                         "interpolation",
                                                         "no-antialias",
                                                         "from-robot",
                                                         "from",
                                                         "source-quat",
                                                         "source-angles",
                                                         "source-unit",
                                                         "source-dof",
                                                         "ignore-header",
                                                         "clean"};

// Options that name files, and their roles in the batch's records.
struct FileRole {
  std::string_view option, role;
};
constexpr std::array<FileRole, 6> kFiles = {{{"smpl-model", "smpl-model"},
                                             {"map", "map"},
                                             {"joint-names", "joint-names"},
                                             {"tpose-file", "tpose-file"},
                                             {"ik-config", "mapping"},
                                             {"limits", "limits"}}};

void set_option(const OptionTable& table, std::string_view name, const std::string& text) {
  const Option* row = find_option(table, name);
  if (row == nullptr || text.empty()) return;
  const auto value = option_value(*row, text);
  if (value) static_cast<void>(row->set(*value));
}

std::string text_of(const nlohmann::ordered_json& json, std::string_view name) {
  const auto found = json.find(std::string(name));
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

nlohmann::ordered_json member(const nlohmann::ordered_json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_object() ? *found : nlohmann::ordered_json::object();
}

// Returns the candidate locations of a file given to a batch: paths are relative to its working
// directory.
std::vector<std::string> places_of(const BatchFolder& batch, const std::string& file) {
  const fs::path beside = fs::path(batch.folder) / file;
  if (file.empty()) return {};
  if (fs::path(file).is_absolute()) return {file};
  return {file, beside.string()};
}

// Restores how a CSV was written; other formats are self-describing.
void take_dialect(const nlohmann::ordered_json& options, ViewArguments& arguments) {
  const std::string formats = text_of(options, "format");
  if (!arguments.motions.front().ends_with(".csv") ||
      formats.find("csv-soma") != std::string::npos) {
    return;
  }
  ReadingOptions& reading = arguments.reading;
  if (const std::string is = text_of(options, "csv-degrees"); !is.empty()) {
    reading.angles = is == "true" ? "deg" : "rad";
  }
  if (const std::string is = text_of(options, "csv-centimetres"); !is.empty()) {
    reading.unit = is == "true" ? "cm" : "m";
  }
  if (const std::string is = text_of(options, "csv-quat"); !is.empty()) {
    reading.quaternion = is == "wxyz" ? QuaternionOrder::kWxyz : QuaternionOrder::kXyzw;
  }
}

// Uses files whose content still matches the batch's record; returns the first that does not.
std::string take_files(const BatchFolder& batch, const nlohmann::ordered_json& description,
                       const OptionTable& table) {
  const auto options = member(description, "options");
  const auto paths = member(description, "paths"), hashes = member(description, "files");
  const auto named = options.find("ik-config-named");
  const bool config_named = named != options.end() && named->is_boolean() && named->get<bool>();
  std::string changed;
  for (const auto& [option, role] : kFiles) {
    const std::string path = text_of(paths, role), hash = text_of(hashes, role);
    if (path.empty() || (role == "mapping" && !config_named)) continue;
    std::string found;
    for (const std::string& place : places_of(batch, path)) {
      const auto is = hash_file(place);
      if (found.empty() && is && *is == hash) found = place;
    }
    if (!found.empty()) {
      set_option(table, option, found);
    } else if (changed.empty()) {
      changed = path;
    }
  }
  return changed;
}

// @return the first option file that has changed or is missing; empty: none.
std::string take_options(const BatchFolder& batch, const nlohmann::ordered_json& description,
                         ViewArguments& arguments) {
  const OptionTable table = run_table(arguments.run.run);
  const auto options = member(description, "options"), paths = member(description, "paths");
  for (const std::string_view name : kOfSources) {
    const std::string text = text_of(options, name);
    if (paths.contains(std::string(name))) continue;
    // A batch records files separately, with their hashes.
    std::error_code ignored;
    const Option* row = find_option(table, name);
    const bool may_be_file = row != nullptr && row->info.file != OptionFile::kNone;
    if (may_be_file && (text.find('/') != std::string::npos || fs::exists(text, ignored))) continue;
    set_option(table, name, text);
  }
  set_option(table, "dof", text_of(description, "dof"));
  take_dialect(options, arguments);
  return take_files(batch, description, table);
}

}  // namespace

Result<BatchFolder> read_batch_folder(const std::string& folder) {
  BatchFolder batch;
  batch.folder = folder;
  int manifests = 0;
  for (const fs::path& file : files_in_folder(folder)) {
    const std::string name = file.filename().string();
    if (!name.starts_with("manifest.") || !name.ends_with(".jsonl") || !is_file(file)) continue;
    RETARGET_TRY_ASSIGN(ManifestContent content, read_manifest(file.string()));
    ++manifests;
    batch.unreadable += content.unreadable + content.outside;
    std::ranges::move(content.entries, std::back_inserter(batch.entries));
  }
  if (manifests == 0) {
    return input_failure(folder, "the folder has no manifest.jsonl",
                         "give the output folder of retarget batch, or motion files");
  }
  batch.entries = latest_entries(std::move(batch.entries));
  for (const fs::path& file : files_in_folder(folder)) {
    const std::string name = file.filename().string();
    if (!name.starts_with("options.") || !name.ends_with(".json")) continue;
    // Unreadable options are treated as absent.
    const auto json = load_json(file.string());
    if (!json || !json->is_array()) continue;
    for (const auto& each : *json) {
      if (each.is_object()) batch.options[text_of(each, "options_hash")] = each;
    }
  }
  return batch;
}

std::string motion_of(const BatchFolder& batch, const ManifestEntry& entry) {
  constexpr std::array<std::string_view, 5> kEndings = {".csv", ".npz", ".pkl", ".pickle",
                                                        ".joblib"};
  for (const std::string_view ending : kEndings) {
    for (const FileRecord& output : entry.outputs) {
      if (output.file.ends_with(ending) && lies_in(batch.folder, output.file)) {
        return (fs::path(batch.folder) / output.file).string();
      }
    }
  }
  return {};
}

RecordedFile find_source(const BatchFolder& batch, const ManifestEntry& entry) {
  RecordedFile source;
  for (const std::string& place : places_of(batch, entry.input.file)) {
    source.is_there = source.is_there || is_file(place);
    if (source.path.empty() && has_recorded_content(entry.input, place)) source.path = place;
  }
  return source;
}

bool source_is_there(const BatchFolder& batch, const ManifestEntry& entry) {
  return std::ranges::any_of(places_of(batch, entry.input.file),
                             [](const std::string& place) { return is_file(place); });
}

RecordedFile find_motion(const BatchFolder& batch, const ManifestEntry& entry) {
  RecordedFile motion;
  const std::string path = motion_of(batch, entry);
  motion.is_there = !path.empty() && is_file(path);
  for (const FileRecord& output : entry.outputs) {
    if ((fs::path(batch.folder) / output.file).string() != path) continue;
    if (has_recorded_content(output, path)) motion.path = path;
  }
  return motion;
}

void forget_source(Run& run) {
  run.motion.clear();
  run.options.part = {};
  // Otherwise it would be applied to the motion.
  run.options.source.source_fps = 0.0;
}

ShownEntry arguments_of(const BatchFolder& batch, const ManifestEntry& entry,
                        const ViewArguments& given, const std::string& given_robot) {
  ShownEntry shown;
  ViewArguments& arguments = shown.arguments;
  arguments.motions = {motion_of(batch, entry)};
  arguments.labels = {fs::path(arguments.motions.front()).filename().string()};
  arguments.run.common = given.run.common;
  arguments.run.common.quiet = true;
  arguments.gates = given.gates;
  const auto options = batch.options.find(entry.options_hash);
  if (options != batch.options.end()) {
    const std::string changed = take_options(batch, options->second, arguments);
    if (!changed.empty())
      shown.lacks = "a file named by the batch's options has changed since: " + changed;
  }
  Run& run = arguments.run.run;
  if (!given_robot.empty() && entry.robot == given_robot) {
    run.robot = given.run.run.robot;
  } else {
    run.robot.name = entry.robot;
  }
  const RecordedFile source = find_source(batch, entry);
  if (!source.path.empty() && shown.lacks.empty()) {
    run.motion = source.path;
  } else if (source.path.empty() && source.is_there) {
    shown.lacks = "the source has changed since: " + entry.input.file;
  }
  if (!entry.variant.part.empty()) run.options.part = part_options(entry.variant.part);
  arguments.run.request.mirror = entry.variant.is_mirrored();
  if (run.motion.empty()) forget_source(run);
  if (entry.fps > 0.0) arguments.fps = to_text(frame_rate_from_fps(entry.fps));
  return shown;
}

}  // namespace retarget::cli
