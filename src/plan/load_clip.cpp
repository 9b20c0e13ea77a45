#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/option_name.h"
#include "base/try.h"
#include "bvh/read_bvh.h"
#include "motion/clip_size.h"
#include "plan/check_options.h"
#include "plan/memory.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "smpl/motion_file.h"
#include "smpl/read_smpl.h"
#include "smpl/smpl_body.h"

namespace retarget {
namespace {

std::optional<double> given_rate(const SourceOptions& options) {
  return options.source_fps > 0.0 ? std::optional<double>(options.source_fps) : std::nullopt;
}

Result<Clip> load_bvh_clip(std::string_view bytes, const std::string& name,
                           const SourceOptions& options, bool skeleton_only) {
  BvhReadOptions read;
  read.lenient = options.lenient;
  read.motion_optional = skeleton_only;
  read.root = options.root;
  read.source_fps = given_rate(options);
  read.max_clip_bytes = memory_share(options.memory_gb);
  TRY_ASSIGN(BvhFile file, read_bvh(bytes, name, read));
  file.clip.set_origin({name, bytes.size(), std::nullopt, std::move(file.warnings)});
  return std::move(file.clip);
}

Result<Clip> load_smpl_clip(std::string_view bytes, const std::string& name,
                            const SourceOptions& options) {
  SmplReadOptions read;
  read.source_fps = given_rate(options);
  read.max_clip_bytes = memory_share(options.memory_gb);
  std::optional<SmplBody> body;
  if (!options.smpl_model.empty()) {
    TRY_ASSIGN(body, load_smpl_body(options.smpl_model));
    read.body = &*body;
  }
  TRY_ASSIGN(SmplMotion motion, read_smpl(bytes, name, read));
  if (motion.approximate_body) {
    motion.warnings.push_back({0, 0,
                               "bone lengths and the zero pose are those of a generic body, "
                               "approximately: limbs may point "
                               "up to 20 degrees elsewhere; " OPTION(
                                   "smpl-model") " FILE takes them from your body model"});
  }
  motion.clip.set_origin({name, bytes.size(), motion.height, std::move(motion.warnings)});
  return std::move(motion.clip);
}

Result<Clip> load(const std::string& file, const SourceOptions& options, bool skeleton_only) {
  const std::string name = file == "-" ? "standard input" : file;
  TRY(check_no_folder(file));
  TRY_ASSIGN(const auto bytes,
             read_file(file, ErrorKind::kInput, memory_share(options.memory_gb), kLargeFileHint));
  const bool is_smpl = options.smpl || looks_like_motion_file(bytes.view());
  if (is_smpl) return load_smpl_clip(bytes.view(), name, options);
  if (!options.smpl_model.empty()) {
    return usage_failure(
        OPTION("smpl-model") " is for SMPL motions, and \"" + name + "\" is not one",
        "leave it out");
  }
  return load_bvh_clip(bytes.view(), name, options, skeleton_only);
}

}  // namespace

Result<void> check_no_folder(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || !std::filesystem::is_directory(path, ignored)) return {};
  return input_failure(
      path, "expected a motion file, found a directory",
      "retarget batch " + path + " -o OUT " OPTION("robot") " NAME takes a folder of clips");
}

Result<Clip> load_clip(const std::string& file, const SourceOptions& options) {
  return load(file, options, false);
}

Result<Clip> load_skeleton(const std::string& file, const SourceOptions& options) {
  return load(file, options, true);
}

}  // namespace retarget
