#include "sidecar.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "provenance/hash.h"
#include "retarget/version.h"
#include "robot/find_robot.h"
#include "robot_mapping.h"
#include "run_options_json.h"

namespace retarget::cli {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

Result<void> add_file(std::vector<ReadFile>& files, const char* role, const fs::path& path,
                      const fs::path& data_folder) {
  if (path.empty()) return {};
  ReadFile file{role, recorded_name(path, data_folder), path.string(), {}};
  // of a pipe nothing is left to be hashed; a file that was read must give its hash
  std::error_code ignored;
  if (!fs::is_fifo(path, ignored)) {
    auto hash = hash_file(file.path);
    if (!hash) return failure(hash.error());
    file.hash = std::move(*hash);
  }
  files.push_back(std::move(file));
  return {};
}

// all dialects together: which of them fits is found by trying
Result<std::string> hash_of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  auto hasher = ContentHasher::create();
  if (!hasher) return failure(hasher.error());
  for (const fs::path& file : files) {
    const auto hash = hash_file(file.string(), ErrorKind::kConfig);
    if (!hash) return failure(hash.error());
    hasher->update(file.filename().string() + " " + *hash + "\n");
  }
  return hasher->finish();
}

const char* scale_name(HeightScale scale) {
  return scale == HeightScale::kPublished    ? "table"
         : scale == HeightScale::kNormalised ? "height"
                                             : "limbs";
}

// what was found in the motion or chosen for it
Json found_json(const RunOptions& options, const ClipSetup& setup, const Source& source) {
  const Calibration& calibration = source.human.calibration;
  Json found;
  found["skeleton"] = calibration.mapping.description;
  found["dialect"] = calibration.mapping.dialect;
  found["unit"] = calibration.unit;
  found["metres_per_unit"] = calibration.mapping.metres_per_unit;
  found["up"] = to_text(calibration.up);
  found["forward"] = to_text(calibration.forward);
  found["rest_pose"] = calibration.rest_pose;
  found["height"] = calibration.mapping.height;
  found["scale"] = scale_name(choose_scale(source.human, *setup.robot, setup.tables, options));
  found["limits"] = setup.limits.name;
  found["fps"] = source.clip.rate().fps();
  found["lead_in_frames"] = source.lead_in;
  Json doubts = Json::array();
  for (const Warning& doubt : calibration.mapping.doubts)
    doubts.push_back(spell_options(doubt.message, option_as_flag));
  found["doubts"] = doubts;
  return found;
}

}  // namespace

Result<std::vector<ReadFile>> files_read(const RunOptions& options, const fs::path& data_folder,
                                         const std::string& mapping) {
  std::vector<ReadFile> files;
  std::string model = options.robot_xml, profile = options.robot_profile;
  if (model.empty()) {
    const auto found = find_robot(options.robot, data_folder / "robots");
    if (!found) return failure(found.error());
    model = found->model.string();
    profile = found->profile.string();
  }
  std::error_code ignored;
  const bool limits_file = fs::is_regular_file(options.limits, ignored);
  if (options.source.file == "-") files.push_back({"motion", "-", "-", {}});
  const std::pair<const char*, std::string> read[] = {
      {"motion", options.source.file == "-" ? "" : options.source.file},
      {"model", model},
      {"profile", profile},
      {"mapping", mapping},
      {"limits", limits_file ? options.limits : ""},
      {"fit-config", options.fit_config},
      {"map", options.human.map},
      {"tpose-file", options.human.tpose_file},
      {"smpl-model", options.source.smpl_model}};
  for (const auto& [role, path] : read) {
    if (auto added = add_file(files, role, path, data_folder); !added) {
      return failure(added.error());
    }
  }
  const fs::path dialects = data_folder / "configs" / "skeletons";
  auto hash = hash_of_folder(dialects);
  if (!hash) return failure(hash.error());
  files.push_back(
      {"skeletons", recorded_name(dialects, data_folder), dialects.string(), std::move(*hash)});
  return files;
}

Result<std::string> sidecar_text(const RunOptions& options, const ClipSetup& setup,
                                 const Source& source, const WrittenFile& output,
                                 const QualityReport& report, const std::vector<ReadFile>& files) {
  Json json;
  json["retarget"] = version_number();
  Json build = Json::array();
  const std::string facts = version_text();
  for (std::size_t begin = 0; begin < facts.size();) {
    const std::size_t end = std::min(facts.find('\n', begin), facts.size());
    build.push_back(facts.substr(begin, end - begin));
    begin = end + 1;
  }
  json["build"] = build;
  json["output"] = Json::object();
  put_name(json["output"], "file", fs::path(output.item.path).filename().string());
  json["output"]["format"] = format_name(output.item.format);
  json["output"]["hash"] = output.hash;
  Json inputs = Json::array();
  for (const ReadFile& file : files) {
    Json& input = inputs.emplace_back(Json::object());
    input["role"] = file.role;
    put_name(input, "file", file.file);
    input["hash"] = file.hash.empty() ? Json() : Json(file.hash);
  }
  json["inputs"] = inputs;
  json["options"] = run_options_json(options);
  json["found"] = found_json(options, setup, source);
  json["quality"] = Json::parse(report_json({&report, 1}), nullptr, false);
  // names of skeletons' parts may be anything: what is no UTF-8 is replaced
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace retarget::cli
