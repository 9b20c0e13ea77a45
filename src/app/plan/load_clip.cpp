#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "app/plan/robot_source.h"
#include "base/option_name.h"
#include "base/try.h"
#include "formats/registry/format.h"
#include "human/skeleton/joint_clip.h"
#include "motion/clip.h"
#include "retarget/check_options.h"
#include "retarget/clip.h"
#include "retarget/file.h"
#include "retarget/load.h"
#include "retarget/options.h"

namespace retarget {
namespace {

Result<Clip> load(const std::string& file, const SourceOptions& options, bool skeleton_only) {
  TRY(check_robot_source(options));
  const std::string name = file == "-" ? "standard input" : file;
  TRY(check_no_folder(file));
  const std::size_t max_bytes = memory_share(options.memory_gb);
  TRY_ASSIGN(const auto bytes, read_file(file, ErrorKind::kInput, max_bytes, kLargeFileHint));
  TRY_ASSIGN(HumanFile human,
             read_human_file(bytes.view(), name, {options, skeleton_only, max_bytes}));
  if (auto* clip = std::get_if<Clip>(&human)) return std::move(*clip);
  TRY_ASSIGN(Clip clip, clip_of_joints(std::get<JointMotion>(human), name));
  ClipOrigin origin = clip.origin();
  origin.bytes = bytes.view().size();
  clip.set_origin(std::move(origin));
  return clip;
}

}  // namespace

Result<void> check_no_folder(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || !std::filesystem::is_directory(path, ignored)) return {};
  return input_failure(
      path, "expected a motion file, found a directory",
      "retarget batch " + path + " -o OUT " OPTION("robot") " NAME takes a folder of clips");
}

Result<Clip> load_clip(const std::string& file, const SourceOptions& options,
                       const DataFolder& data_folder) {
  if (!options.from_robot.empty()) return load_robot_clip(file, options, data_folder);
  return load(file, options, false);
}

Result<Clip> load_skeleton(const std::string& file, const SourceOptions& options) {
  if (!options.from_robot.empty()) {
    return usage_failure(
        OPTION("from-robot") " describes a robot motion, but a skeleton was requested", "omit it");
  }
  return load(file, options, true);
}

}  // namespace retarget
