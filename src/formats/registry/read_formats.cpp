// Reads motion files of any format of the table.

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <system_error>
#include <utility>
#include <variant>

#include "base/json.h"
#include "base/option_name.h"
#include "base/try.h"
#include "formats/bvh/read_bvh.h"
#include "formats/registry/format.h"
#include "formats/scene/read_scene.h"
#include "formats/smpl/read_smpl.h"
#include "formats/smpl/smpl_body.h"
#include "motion/clip.h"
#include "retarget/file.h"
#include "retarget/os.h"
#include "retarget/text.h"
#include "robot/model/variant.h"

namespace retarget {
namespace {

constexpr const char* kFromRobotHint =
    "if it is a robot motion, " OPTION("from-robot") " NAME names the robot, such as unitree_g1; "
    "retarget convert only changes its format. A human's joint positions are read from arrays: "
    "docs/positions.md";

std::optional<double> given_rate(const SourceOptions& options) {
  return options.source_fps > 0.0 ? std::optional<double>(options.source_fps) : std::nullopt;
}

Failure no_smpl(const std::string& name) {
  return usage_failure(
      OPTION("smpl-model") " applies only to SMPL motions, and \"" + name + "\" is not one",
      "omit it");
}

Failure no_positions(const std::string& name) {
  return usage_failure(
      OPTION("joint-names") " applies only to joint positions without rotations, and \"" + name +
          "\" contains something else",
      "omit it");
}

// Reads a JSON list of names, or one name per line.
Result<std::vector<std::string>> load_joint_names(const std::string& file) {
  std::vector<std::string> names;
  if (file.empty()) return names;
  constexpr std::size_t kMaxBytes = std::size_t{1} << 20U;
  TRY_ASSIGN(const auto bytes, read_file(file, ErrorKind::kConfig, kMaxBytes));
  constexpr const char* kHint = "one name per line, or a JSON list";
  std::string_view text = without_byte_order_mark(bytes.view());
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.starts_with('[') || text.starts_with('{')) {
    TRY_ASSIGN(const auto json, parse_json(text, file));
    if (!json.is_array()) {
      return config_failure(file, "expected a JSON list of joint names, found an object", kHint);
    }
    for (const auto& name : json) {
      if (!name.is_string()) {
        return config_failure(file, "expected a list of joint names, found another value in it");
      }
      names.push_back(name.get<std::string>());
    }
  } else {
    while (!text.empty()) {
      std::string_view line = take_until(text, '\n');
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) {
        line.remove_suffix(1);
      }
      if (!line.empty()) names.emplace_back(line);
    }
    if (names.size() == 1 && names.front().find(',') != std::string::npos) {
      return config_failure(file, "expected one name per line, found one line with commas", kHint);
    }
  }
  if (!names.empty()) return names;
  return config_failure(file, "the file contains no joint names", kHint);
}

// Rejects options that state the type of a file, or select a part of it, for other types of files.
Result<void> check_options(const std::string& file, const SourceOptions& options,
                           const Format& format) {
  const bool has_arrays = format.family.read_human == read_array_file;
  if (!options.smpl_model.empty() && !has_arrays) return no_smpl(file);
  if (!options.joint_names.empty() && !has_arrays) return no_positions(file);
  if (!options.root.empty() && has_arrays) {
    return usage_failure(OPTION("root") " applies only to files with a tree of joints, and \"" +
                             file + "\" contains arrays",
                         "omit it; " OPTION("take") " selects one of several motions");
  }
  if (!options.take.empty() && format.family.read_human == read_bvh_file) {
    return usage_failure(OPTION("take") " applies only to files with several motions, and \"" +
                             file + "\" contains one motion",
                         "omit it");
  }
  return {};
}

// Also numbers out of range, and those that are not finite.
bool looks_like_number(std::string_view cell) {
  constexpr auto kNone = std::string_view::npos;
  const bool has_digit = cell.find_first_of("0123456789") != kNone;
  return (has_digit && cell.find_first_not_of("0123456789+-.eE") == kNone) ||
         parse_number<double>(cell);
}

bool is_row_of_numbers(std::string_view line) {
  constexpr std::string_view kSeparators = ", \t;\r";
  bool has_number = false;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(kSeparators), line.size());
    if (end > 0 && !looks_like_number(line.substr(0, end))) return false;
    has_number = has_number || end > 0;
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return has_number;
}

// Whether a text is a table of numbers, perhaps below a header.
bool is_table(std::string_view bytes) {
  const std::string_view first = take_until(bytes, '\n');
  return is_row_of_numbers(first) || is_row_of_numbers(take_until(bytes, '\n'));
}

// Whether the bytes of an archive or a pickle name an array. `joint_positions` is not `joint_pos`.
bool names_array(std::string_view bytes, std::string_view name) {
  const auto is_of_word = [](char c) {
    return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0;
  };
  const char length = static_cast<char>(name.size());
  for (std::size_t at = bytes.find(name); at != std::string_view::npos;
       at = bytes.find(name, at + 1)) {
    const std::string_view rest = bytes.substr(at + name.size());
    const bool is_ended = rest.empty() || !is_of_word(rest.front());
    // An instruction of the pickle, which may be a letter, follows a text and its length.
    const std::string_view before = bytes.substr(0, at);
    if (is_ended || before.ends_with(length) ||
        before.ends_with(std::string({length, '\0', '\0', '\0'}))) {
      return true;
    }
  }
  return false;
}

// Whether content that is not a human motion may be a robot's: a table of numbers, or arrays with
// the names of one of its formats.
bool may_be_of_robot(const std::string& name, std::string_view bytes) {
  return ending_of(name) == format_ending(MotionFormat::kCsv) || is_table(bytes) ||
         std::ranges::any_of(all_formats(), [&](const Format& format) {
           return !format.array.empty() && names_array(bytes, format.array);
         });
}

// The error for content of an unknown type whose name announces another type than the reader's.
std::optional<Failure> other_than_named(const std::string& file, FileKind type) {
  if (type != FileKind::kOther) return std::nullopt;
  const std::string_view lack = missing_header(ending_of(file));
  if (lack.empty()) return std::nullopt;
  return input_failure(file, std::string(lack), kWrongEndingHint);
}

// Reads bytes by their type, which decides between the families of robot formats.
Result<RawMotion> read_raw(std::string_view bytes, const std::shared_ptr<const Robot>& robot,
                           const std::string& file, const ReadMotionOptions& options) {
  const FileType type = file_type(bytes);
  for (const Format& format : all_formats()) {
    if (!format.is_robots() || !format.family.reads(type.kind)) continue;
    if (format.family.read_robot == nullptr) {
      return input_failure(file,
                           "the file is " + std::string(type.what) +
                               ", which is for display and cannot be converted back",
                           "give the motion file that it was made from, such as walk.csv");
    }
    auto raw = format.family.read_robot(bytes, robot, file, options);
    // The type explains more than the position of the first line that is not CSV.
    if (!raw && type.kind == FileKind::kForeign && !bytes.empty()) {
      return input_failure(file, "the file is " + std::string(type.what), std::string(type.hint));
    }
    // The position in a table explains more than the name.
    if (!raw && raw.error().kind == ErrorKind::kInput && !is_table(bytes)) {
      if (auto other = other_than_named(file, type.kind)) return *std::move(other);
    }
    return raw;
  }
  return input_failure(file, "the file is " + std::string(type.what) + ", a human motion",
                       "retarget it to a robot, and give the robot motion");
}

using ReadRaw =
    std::function<Result<RawMotion>(const std::shared_ptr<const Robot>&, const ReadMotionOptions&)>;

// Reads a motion of the whole robot. Files may name joints that the model of a variant lacks, or
// have the columns of other variants.
Result<RobotMotion> motion_of(const std::shared_ptr<const Robot>& robot, const std::string& file,
                              const ReadMotionOptions& options, const ReadRaw& read) {
  if (robot->whole()) {
    ReadMotionOptions of_whole = options;
    if (of_whole.variant.empty()) of_whole.variant = robot->variant().name;
    TRY_ASSIGN(auto motion, motion_of(robot->whole(), file, of_whole, read));
    motion.clip = with_robot(motion.clip, robot);
    return motion;
  }
  // Reject unknown variants.
  if (!options.variant.empty()) {
    TRY(robot_variant(robot, options.variant));
  }
  TRY_ASSIGN(auto raw, read(robot, options));
  return interpret_motion(raw, robot, file, options);
}

}  // namespace

Result<HumanFile> read_bvh_file(std::string_view bytes, const std::string& file,
                                const HumanReadOptions& options) {
  BvhReadOptions read;
  read.lenient = options.source.lenient;
  read.motion_optional = options.skeleton_only;
  read.root = options.source.root;
  read.source_fps = given_rate(options.source);
  read.max_clip_bytes = options.max_bytes;
  TRY_ASSIGN(BvhFile bvh, read_bvh(bytes, file, read));
  ClipOrigin origin;
  origin.name = file;
  origin.bytes = bytes.size();
  origin.warnings = std::move(bvh.warnings);
  bvh.clip.set_origin(std::move(origin));
  return HumanFile(std::move(bvh.clip));
}

Result<HumanFile> read_array_file(std::string_view bytes, const std::string& file,
                                  const HumanReadOptions& options) {
  ArrayReadOptions read;
  read.source_fps = given_rate(options.source);
  read.max_clip_bytes = options.max_bytes;
  std::optional<SmplBody> body;
  if (!options.source.smpl_model.empty()) {
    TRY_ASSIGN(body, load_smpl_body(options.source.smpl_model));
    read.body = &*body;
  }
  read.take = options.source.take;
  TRY_ASSIGN(read.joint_names, load_joint_names(options.source.joint_names));
  TRY_ASSIGN(ArrayMotion content, read_array_motion(bytes, file, read));
  if (auto* joints = std::get_if<JointMotion>(&content)) {
    if (read.body != nullptr) return no_smpl(file);
    return HumanFile(std::move(*joints));
  }
  if (!options.source.joint_names.empty()) return no_positions(file);
  SmplMotion& motion = std::get<SmplMotion>(content);
  if (motion.approximate_body) {
    motion.warnings.push_back(
        {0, 0,
         "bone lengths and the zero pose are those of a generic body, so limbs "
         "may be up to 20 degrees off; pass your body model with " OPTION("smpl-model")});
  }
  ClipOrigin origin;
  origin.name = file;
  origin.bytes = bytes.size();
  origin.body_height = motion.height;
  origin.up = motion.up;
  origin.warnings = std::move(motion.warnings);
  motion.clip.set_origin(std::move(origin));
  return HumanFile(std::move(motion.clip));
}

Result<HumanFile> read_scene_file(std::string_view bytes, const std::string& file,
                                  const HumanReadOptions& options) {
  SceneReadOptions read;
  read.take = options.source.take;
  read.root = options.source.root;
  read.source_fps = given_rate(options.source);
  read.skeleton_only = options.skeleton_only;
  read.max_clip_bytes = options.max_bytes;
  TRY_ASSIGN(Clip clip, read_scene(bytes, file, read));
  return HumanFile(std::move(clip));
}

Result<void> check_start_of_large_file(const std::string& path) {
  constexpr std::uint64_t kLarge = std::uint64_t{16} << 20U;
  const auto status = os::status_of(path);
  if (!status || status->kind != os::EntryKind::kRegular || status->bytes < kLarge) return {};
  const int descriptor = os::open_file(path, os::OpenFor::kReading);
  if (descriptor < 0) return {};
  std::array<char, 4096> start;
  const std::int64_t count = os::read_bytes(descriptor, start.data(), start.size());
  os::close_file(descriptor);
  if (count <= 0) return {};
  const std::string_view bytes(start.data(), static_cast<std::size_t>(count));
  // The type of a text may depend on all of it.
  if (bytes.find('\0') == std::string_view::npos) return {};
  const FileType type = file_type(bytes);
  if (type.kind == FileKind::kForeign) {
    return input_failure(path, "the file is " + std::string(type.what), std::string(type.hint));
  }
  if (type.kind != FileKind::kOther) return {};
  return input_failure(path, "the file begins with binary data of an unknown type",
                       "give a file with the motion of a human or a robot");
}

bool may_hold_human_motion(const std::string& path, std::size_t max_bytes) {
  if (!check_start_of_large_file(path)) return false;
  const auto content = read_file(path, ErrorKind::kInput, max_bytes);
  return !content || may_hold_array_motion(content->view());
}

Result<HumanFile> read_human_file(std::string_view bytes, const std::string& file,
                                  const HumanReadOptions& options) {
  const FileKind type = file_type(bytes).kind;
  const FileKind kind = options.source.smpl ? FileKind::kNpz : type;
  const auto formats = all_formats();
  const Format& format = *std::ranges::find_if(formats, [kind](const Format& row) {
    return row.family.read_human != nullptr && row.family.reads(kind);
  });
  auto read = format.family.read_human(bytes, file, options);
  // A fault of the file explains more than an option that does not apply to its type.
  if (read || read.error().kind != ErrorKind::kInput) {
    TRY(check_options(file, options.source, format));
  }
  if (!read && read.error().kind == ErrorKind::kInput && !options.source.smpl) {
    if (auto other = other_than_named(file, type)) read = *std::move(other);
  }
  if (!read && read.error().kind == ErrorKind::kInput &&
      format.family.read_human != read_scene_file && type != FileKind::kForeign &&
      may_be_of_robot(file, bytes)) {
    read.error().hint = kFromRobotHint;
  }
  return read;
}

Result<RobotMotion> parse_robot_motion(std::string_view bytes,
                                       const std::shared_ptr<const Robot>& robot,
                                       const std::string& file, const ReadMotionOptions& options) {
  auto motion =
      motion_of(robot, file, options,
                [&](const std::shared_ptr<const Robot>& whole, const ReadMotionOptions& of_whole) {
                  return read_raw(bytes, whole, file, of_whole);
                });
  if (motion) motion->bytes = bytes.size();
  return motion;
}

Result<RobotMotion> load_robot_motion(const std::string& path,
                                      const std::shared_ptr<const Robot>& robot,
                                      const ReadMotionOptions& options) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    if (is_sonic_folder(path)) {
      return motion_of(
          robot, path, options,
          [&](const std::shared_ptr<const Robot>& whole, const ReadMotionOptions& of_whole) {
            return read_sonic_folder({}, whole, path, of_whole);
          });
    }
    return input_failure(path, "expected a robot motion, found a directory",
                         "give files in it, such as " +
                             (std::filesystem::path(path) / "*.csv").string() +
                             "; folders of human motions are for retarget batch");
  }
  TRY(check_start_of_large_file(path));
  TRY_ASSIGN(const auto content,
             read_file(path, ErrorKind::kInput, options.max_bytes, kLargeFileHint));
  return parse_robot_motion(content.view(), robot, path == "-" ? "standard input" : path, options);
}

}  // namespace retarget
