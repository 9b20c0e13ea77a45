#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "base/file.h"
#include "base/json.h"
#include "base/lower_case.h"
#include "base/option_name.h"
#include "base/try.h"
#include "bvh/foreign_file.h"
#include "bvh/read_bvh.h"
#include "human/joint_clip.h"
#include "motion/clip_size.h"
#include "plan/check_options.h"
#include "plan/memory.h"
#include "plan/robot_source.h"
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

Failure no_smpl(const std::string& name) {
  return usage_failure(OPTION("smpl-model") " is for SMPL motions, and \"" + name + "\" is not one",
                       "leave it out");
}

Failure no_places(const std::string& name) {
  return usage_failure(OPTION("joint-names") " is for places of joints without rotations, and \"" +
                           name + "\" holds something else",
                       "leave it out");
}

// a JSON list of names, or a name a line
Result<std::vector<std::string>> load_joint_names(const std::string& file) {
  std::vector<std::string> names;
  if (file.empty()) return names;
  constexpr std::size_t kMaxBytes = std::size_t{1} << 20U;
  TRY_ASSIGN(const auto bytes, read_file(file, ErrorKind::kConfig, kMaxBytes));
  constexpr const char* kHint = "one name a line, or a JSON list";
  constexpr std::string_view kBom = "\xef\xbb\xbf";
  std::string_view text = bytes.view();
  if (text.starts_with(kBom)) text.remove_prefix(kBom.size());
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.starts_with('[') || text.starts_with('{')) {
    TRY_ASSIGN(const auto json, parse_json(text, file));
    if (!json.is_array()) {
      return config_failure(file, "expected a JSON list of joints' names, found an object", kHint);
    }
    for (const auto& name : json) {
      if (!name.is_string()) {
        return config_failure(file, "expected a list of joints' names, found something else in it");
      }
      names.push_back(name.get<std::string>());
    }
  } else {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) {
        line.remove_suffix(1);
      }
      if (!line.empty()) names.emplace_back(line);
    }
    if (names.size() == 1 && names.front().find(',') != std::string::npos) {
      return config_failure(file, "expected a name a line, found one line with commas", kHint);
    }
  }
  if (!names.empty()) return names;
  return config_failure(file, "the file names no joints", kHint);
}

Result<Clip> load_array_clip(std::string_view bytes, const std::string& name,
                             const SourceOptions& options) {
  SmplReadOptions read;
  read.fingers = true;
  read.source_fps = given_rate(options);
  read.max_clip_bytes = memory_share(options.memory_gb);
  std::optional<SmplBody> body;
  if (!options.smpl_model.empty()) {
    TRY_ASSIGN(body, load_smpl_body(options.smpl_model));
    read.body = &*body;
  }
  read.take = options.take;
  TRY_ASSIGN(read.joint_names, load_joint_names(options.joint_names));
  TRY_ASSIGN(ArrayMotion content, read_array_motion(bytes, name, read));
  if (const auto* joints = std::get_if<JointMotion>(&content)) {
    if (read.body != nullptr) return no_smpl(name);
    TRY_ASSIGN(Clip clip, clip_of_joints(*joints, name));
    ClipOrigin origin = clip.origin();
    origin.bytes = bytes.size();
    clip.set_origin(std::move(origin));
    return clip;
  }
  if (!options.joint_names.empty()) return no_places(name);
  SmplMotion& motion = std::get<SmplMotion>(content);
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
Result<void> check_kind(const std::string& name, const SourceOptions& options, bool has_arrays,
                        bool is_scene) {
  if (!options.smpl_model.empty() && !has_arrays) return no_smpl(name);
  if (!options.joint_names.empty() && !has_arrays) return no_places(name);
  if (!options.take.empty() && !has_arrays && !is_scene) {
    return usage_failure(OPTION("take") " is for files with several motions, and \"" + name +
                             "\" holds one motion alone",
                         "leave it out");
  }
  return {};
}

// what is no human's motion may be a robot's: a table of numbers, or arrays of joints under their names
bool may_be_of_robot(const std::string& name, std::string_view bytes) {
  constexpr std::array<std::string_view, 5> kArrays = {"joint_pos", "dof_pos", "root_trans_offset",
                                                       "loop_mode", "rigid_body_pos"};
  const std::string_view start = bytes.substr(0, bytes.find('\n'));
  constexpr auto kNone = std::string_view::npos;
  const bool is_table = lower_case(name).ends_with(".csv") ||
                        (start.find_first_of("0123456789") != kNone &&
                         start.find_first_not_of("0123456789+-.eE, \t;\r") == kNone);
  return is_table || std::ranges::any_of(kArrays, [&](std::string_view array) {
           return bytes.find(array) != std::string_view::npos;
         });
}

Result<Clip> hinting_at_robots(Result<Clip> clip, const std::string& name, std::string_view bytes) {
  if (!clip && clip.error().kind == ErrorKind::kInput && !bytes.empty() &&
      may_be_of_robot(name, bytes)) {
    clip.error().hint = std::string(kFromRobotHint) + "; retarget convert changes its format alone";
  }
  return clip;
}

Result<Clip> load(const std::string& file, const SourceOptions& options, bool skeleton_only) {
  TRY(check_robot_source(options));
  const std::string name = file == "-" ? "standard input" : file;
  TRY(check_no_folder(file));
  TRY_ASSIGN(const auto bytes,
             read_file(file, ErrorKind::kInput, memory_share(options.memory_gb), kLargeFileHint));
  const bool has_arrays =
      options.smpl || (looks_like_motion_file(bytes.view()) && !is_usd_archive(bytes.view()));
  const bool is_scene = !has_arrays && looks_like_scene(bytes.view());
  TRY(check_kind(name, options, has_arrays, is_scene));
  if (has_arrays) {
    return hinting_at_robots(load_array_clip(bytes.view(), name, options), name, bytes.view());
  }
  if (is_scene) return load_scene_clip(bytes.view(), name, options, skeleton_only);
  return hinting_at_robots(load_bvh_clip(bytes.view(), name, options, skeleton_only), name,
                           bytes.view());
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
        OPTION("from-robot") " is for a robot's motion, and a skeleton is asked for",
        "leave it out");
  }
  return load(file, options, true);
}

}  // namespace retarget
