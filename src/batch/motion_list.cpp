#include "batch/motion_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <vector>

#include "batch/manifest.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

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
  std::string text = fmt::format("root_path: {}\nmotions:\n",
                                 quoted(fs::absolute(folder, ignored).lexically_normal().string()));
  for (const std::string& file : files) {
    const std::string name = fs::path(file).filename().string();
    text += fmt::format("  - file: {}\n    weight: 1.0\n    description: {}\n", quoted(file),
                        quoted(name.substr(0, name.find('.'))));
  }
  return text;
}

}  // namespace

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
