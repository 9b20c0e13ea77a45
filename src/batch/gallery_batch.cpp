#include "batch/gallery_batch.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "batch/resume.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/hash.h"
#include "retarget/json.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

std::string text_of(const nlohmann::ordered_json& json, std::string_view name) {
  const auto found = json.find(std::string(name));
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Returns the candidate locations of a file given to a batch: paths are relative to its working
// directory.
std::vector<std::string> places_of(const BatchFolder& batch, const std::string& file) {
  const fs::path beside = fs::path(batch.folder) / file;
  if (file.empty()) return {};
  if (fs::path(file).is_absolute()) return {file};
  return {file, beside.string()};
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

ShownEntry show_entry(const BatchFolder& batch, const ManifestEntry& entry,
                      const GalleryRequest& given, const std::string& given_robot) {
  ShownEntry shown;
  MeasureRequest& request = shown.request;
  const std::string motion = motion_of(batch, entry);
  request.motions = {motion};
  shown.label = fs::path(motion).filename().string();
  request.data_folder = given.data_folder;
  request.gates = given.gates;
  Run& run = request.run;
  const auto options = batch.options.find(entry.options_hash);
  if (options != batch.options.end()) {
    const auto find = [&](const std::string& path, const std::string& hash) -> std::string {
      for (const std::string& place : places_of(batch, path)) {
        const auto is = hash_file(place);
        if (is && *is == hash) return place;
      }
      return {};
    };
    const std::string changed = restore_options(options->second, find, run);
    if (motion.ends_with(".csv")) request.reading = restored_dialect(options->second);
    if (!changed.empty()) {
      shown.lacks = "a file named by the batch's options has changed since: " + changed;
    }
  }
  if (!given_robot.empty() && entry.robot == given_robot) {
    run.robot = given.robot;
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
  request.of_source.mirror = entry.variant.is_mirrored();
  if (run.motion.empty()) forget_source(run);
  if (entry.fps > 0.0) request.fps = to_text(frame_rate_from_fps(entry.fps));
  return shown;
}

}  // namespace retarget
