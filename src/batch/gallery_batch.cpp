#include "batch/gallery_batch.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "batch/data_set.h"
#include "batch/input_variants.h"
#include "batch/resume.h"
#include "retarget/file.h"
#include "retarget/fingerprint.h"
#include "retarget/hash.h"
#include "retarget/json.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Returns the candidate locations of a file given to a batch: paths are relative to its working
// directory.
std::vector<std::string> places_of(const BatchFolder& batch, const std::string& file) {
  const fs::path beside = fs::path(batch.folder) / file;
  if (file.empty()) return {};
  if (fs::path(file).is_absolute()) return {file};
  return {file, beside.generic_string()};
}

constexpr std::size_t kLongestName = 60, kHashDigits = 8;

bool is_name_letter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
}

bool is_gallery_name(std::string_view name) {
  if (name.size() < kHashDigits + 2 || name.size() > kLongestName + 1 + kHashDigits) return false;
  const std::string_view hash = name.substr(name.size() - kHashDigits);
  return name[name.size() - kHashDigits - 1] == '-' && std::ranges::all_of(name, is_name_letter) &&
         hash.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

Failure among_the_batch(const std::string& output) {
  return usage_failure(
      "the gallery would be written among the batch's own files",
      "give another folder, such as " + (fs::path(output) / "gallery").generic_string());
}

// Finds the source of an entry: relative to the working directory, otherwise to the batch's
// folder.
RecordedFile find_source(const BatchFolder& batch, const ManifestEntry& entry) {
  RecordedFile source;
  for (const std::string& place : places_of(batch, entry.input.file)) {
    source.is_there = source.is_there || is_file(place);
    if (source.path.empty() && has_recorded_content(entry.input, place, FileUse::kInput)) {
      source.path = place;
    }
  }
  return source;
}

}  // namespace

Result<BatchFolder> read_batch_folder(const std::string& folder) {
  BatchFolder batch;
  batch.folder = folder;
  int manifests = 0;
  for (const fs::path& file : files_in_folder(folder)) {
    const std::string name = file.filename().generic_string();
    if (!name.starts_with("manifest.") || !name.ends_with(".jsonl") || !is_file(file)) continue;
    RETARGET_TRY_ASSIGN(ManifestContent content, read_manifest(file.generic_string()));
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
    const std::string name = file.filename().generic_string();
    if (!name.starts_with("options.") || !name.ends_with(".json")) continue;
    // Unreadable options are treated as absent.
    const auto json = load_json(file.generic_string());
    if (!json || !json->is_array()) continue;
    for (const auto& each : *json) {
      if (each.is_object()) batch.options[text_at(each, "options_hash")] = each;
    }
  }
  return batch;
}

std::string motion_of(const BatchFolder& batch, const ManifestEntry& entry) {
  constexpr std::array<std::string_view, 5> kEndings = {".csv", ".npz", ".pkl", ".pickle",
                                                        ".joblib"};
  const std::vector<std::string> motions = motions_of(entry);
  for (const std::string_view ending : kEndings) {
    for (const std::string& motion : motions) {
      if (motion.ends_with(ending) && lies_in(batch.folder, motion)) {
        return (fs::path(batch.folder) / motion).generic_string();
      }
    }
  }
  return {};
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
    if ((fs::path(batch.folder) / output.file).generic_string() != path) continue;
    if (has_recorded_content(output, path, FileUse::kOutput)) motion.path = path;
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
  shown.label = fs::path(motion).filename().generic_string();
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
  apply_changes(entry.variant.changes, run.options.solve);
  request.of_source.mirror = entry.variant.is_mirrored();
  if (run.motion.empty()) forget_source(run);
  // Other formats state their rate, which may differ from the batch's.
  if (entry.fps > 0.0 && motion.ends_with(".csv"))
    request.fps = to_text(frame_rate_from_fps(entry.fps));
  return shown;
}

Result<std::string> gallery_name(const ManifestEntry& entry) {
  std::string name = entry.relative + "-" + entry.robot;
  RETARGET_TRY_ASSIGN(const std::string hash, hash_bytes(entry.relative + '\0' + entry.robot));
  for (char& letter : name) {
    if (!is_name_letter(letter)) letter = '_';
  }
  return name.substr(0, kLongestName) + "-" +
         hash.substr(std::string_view("sha256:").size(), kHashDigits);
}

Result<void> check_gallery_folder(const std::string& output, const BatchFolder& batch) {
  std::error_code ignored;
  if (!fs::exists(output, ignored)) return {};
  if (fs::equivalent(output, batch.folder, ignored)) return among_the_batch(output);
  for (const fs::path& file : files_in_folder(output)) {
    const std::string name = file.filename().generic_string();
    if (name.starts_with("manifest") && name.ends_with(".jsonl")) return among_the_batch(output);
  }
  std::set<fs::path> folders;
  for (const ManifestEntry& entry : batch.entries) {
    for (const FileRecord& made : entry.outputs) {
      folders.insert((fs::path(batch.folder) / made.file).parent_path());
    }
    folders.insert(fs::absolute(entry.input.file, ignored).parent_path());
  }
  const fs::path pages = fs::path(output) / kGalleryPages;
  for (const fs::path& folder : folders) {
    if (!fs::exists(folder, ignored)) continue;
    if (fs::equivalent(folder, output, ignored) ||
        (fs::exists(pages, ignored) && is_below(folder, pages))) {
      return among_the_batch(output);
    }
  }
  return {};
}

void remove_stale_pages(const fs::path& pages, const std::set<std::string>& kept) {
  for (const fs::path& file : files_in_folder(pages)) {
    const std::string ending = file.extension().generic_string();
    if (ending != ".html" && ending != ".png") continue;
    if (kept.contains(file.filename().generic_string()) || !is_file(file)) continue;
    if (!is_gallery_name(file.stem().generic_string())) continue;
    // Failure is harmless: no page links to the file.
    std::error_code ignored;
    fs::remove(file, ignored);
  }
}

}  // namespace retarget
