#include "gallery_batch.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "argument_tables.h"
#include "base/file.h"
#include "base/json.h"
#include "base/plain_name.h"
#include "base/try.h"
#include "options/run_tables.h"

namespace retarget::cli {
namespace {

namespace fs = std::filesystem;

// what the options of a batch say about its sources
constexpr std::array<std::string_view, 21> kOfSources = {
    "smpl-model",  "lenient",    "root",    "source-fps", "map",     "partial", "rest",
    "tpose-frame", "tpose-file", "unit",    "up",         "forward", "height",  "start",
    "end",         "frames",     "lead-in", "scale",      "limits",  "dof",     "normalize-start"};

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

void take_options(const nlohmann::ordered_json& description, ViewArguments& arguments) {
  const OptionTable table = run_table(arguments.run.run);
  for (const char* part : {"options", "paths"}) {
    const auto options = description.find(part);
    if (options == description.end() || !options->is_object()) continue;
    for (const std::string_view name : kOfSources) set_option(table, name, text_of(*options, name));
  }
  set_option(table, "dof", text_of(description, "dof"));
  const auto options = description.find("options");
  if (options == description.end()) return;
  if (text_of(*options, "csv-degrees") == "true") arguments.reading.angles = "deg";
  if (text_of(*options, "csv-centimetres") == "true") arguments.reading.unit = "cm";
  if (text_of(*options, "csv-quat") == "wxyz")
    arguments.reading.quaternion = QuaternionOrder::kWxyz;
}

}  // namespace

Result<BatchFolder> read_batch_folder(const std::string& folder) {
  BatchFolder batch;
  batch.folder = folder;
  int manifests = 0;
  for (const fs::path& file : files_in_folder(folder)) {
    const std::string name = file.filename().string();
    if (!name.starts_with("manifest.") || !name.ends_with(".jsonl") || !is_file(file)) continue;
    TRY_ASSIGN(ManifestContent content, read_manifest(file.string()));
    ++manifests;
    batch.unreadable += content.unreadable + content.outside;
    std::ranges::move(content.entries, std::back_inserter(batch.entries));
  }
  if (manifests == 0) {
    return input_failure(folder, "the folder has no manifest.jsonl",
                         "name the output folder of retarget batch, or motions");
  }
  batch.entries = latest_entries(std::move(batch.entries));
  for (const fs::path& file : files_in_folder(folder)) {
    const std::string name = file.filename().string();
    if (!name.starts_with("options.") || !name.ends_with(".json")) continue;
    // what cannot be read is as if it had not been given
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

ViewArguments arguments_of(const BatchFolder& batch, const ManifestEntry& entry,
                           const ViewArguments& given) {
  ViewArguments arguments;
  arguments.run.common = given.run.common;
  arguments.run.common.quiet = true;
  arguments.gates = given.gates;
  const auto options = batch.options.find(entry.options_hash);
  if (options != batch.options.end()) take_options(options->second, arguments);
  Run& run = arguments.run.run;
  const RobotChoice& robot = given.run.run.robot;
  const bool is_given = !robot.name.empty() || !robot.model.empty();
  if (is_given) {
    run.robot = robot;
  } else {
    run.robot.name = entry.robot;
  }
  if (is_file(entry.input.file)) run.motion = entry.input.file;
  if (entry.fps > 0.0) arguments.fps = to_text(frame_rate_from_fps(entry.fps));
  arguments.motions = {motion_of(batch, entry)};
  arguments.labels = {fs::path(arguments.motions.front()).filename().string()};
  return arguments;
}

}  // namespace retarget::cli
