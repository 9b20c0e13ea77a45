#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/option_name.h"
#include "base/try.h"
#include "bvh/foreign_file.h"
#include "bvh/read_bvh.h"
#include "motion/clip_size.h"
#include "plan/check_options.h"
#include "plan/memory.h"
#include "retarget/clip.h"
#include "retarget/load.h"
#include "retarget/options.h"
#include "scene/read_scene.h"
#include "smpl/motion_file.h"
#include "smpl/read_smpl.h"
#include "smpl/smpl_body.h"

namespace retarget {
namespace {

std::optional<double> given_rate(const SourceOptions& options) {
  return options.source_fps > 0.0 ? std::optional<double>(options.source_fps) : std::nullopt;
}

void set_origin(Clip& clip, const std::string& name, std::size_t bytes,
                std::vector<Warning> warnings, std::optional<double> height = std::nullopt) {
  ClipOrigin origin;
  origin.name = name;
  origin.bytes = bytes;
  origin.body_height = height;
  origin.warnings = std::move(warnings);
  clip.set_origin(std::move(origin));
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
  set_origin(file.clip, name, bytes.size(), std::move(file.warnings));
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
  set_origin(motion.clip, name, bytes.size(), std::move(motion.warnings), motion.height);
  return std::move(motion.clip);
}

Result<Clip> load_scene_clip(std::string_view bytes, const std::string& name,
                             const SourceOptions& options, bool skeleton_only) {
  SceneReadOptions read;
  read.take = options.take;
  read.root = options.root;
  read.source_fps = given_rate(options);
  read.skeleton_only = skeleton_only;
  read.max_clip_bytes = memory_share(options.memory_gb);
  return read_scene(bytes, name, read);
}

// options that say what a file is, or which part of it, where it is another kind of file
Result<void> check_kind(const std::string& name, const SourceOptions& options, bool is_smpl,
                        bool is_scene) {
  if (!options.smpl_model.empty() && !is_smpl) {
    return usage_failure(
        OPTION("smpl-model") " is for SMPL motions, and \"" + name + "\" is not one",
        "leave it out");
  }
  if (!options.take.empty() && !is_scene) {
    return usage_failure(
        OPTION("take") " is for FBX and glTF files, and \"" + name + "\" holds one motion alone",
        "leave it out");
  }
  return {};
}

Result<Clip> load(const std::string& file, const SourceOptions& options, bool skeleton_only) {
  const std::string name = file == "-" ? "standard input" : file;
  TRY(check_no_folder(file));
  TRY_ASSIGN(const auto bytes,
             read_file(file, ErrorKind::kInput, memory_share(options.memory_gb), kLargeFileHint));
  const bool is_smpl =
      options.smpl || (looks_like_motion_file(bytes.view()) && !is_usd_archive(bytes.view()));
  const bool is_scene = !is_smpl && looks_like_scene(bytes.view());
  TRY(check_kind(name, options, is_smpl, is_scene));
  if (is_smpl) return load_smpl_clip(bytes.view(), name, options);
  if (is_scene) return load_scene_clip(bytes.view(), name, options, skeleton_only);
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
