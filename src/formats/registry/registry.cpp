#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <iterator>

#include "formats/registry/format.h"
#include "formats/robot_motion/motion_writers.h"
#include "retarget/enum_names.h"
#include "retarget/text.h"

namespace retarget {
namespace {

constexpr unsigned kinds_of(std::initializer_list<FileKind> kinds) {
  unsigned bits = 0;
  for (const FileKind kind : kinds) bits |= 1U << static_cast<unsigned>(kind);
  return bits;
}

// Readers of BVH and CSV also receive content of unknown types, because their messages name the
// line and column that they cannot read.
constexpr FormatFamily kBvh = {kinds_of({FileKind::kBvh, FileKind::kOther, FileKind::kForeign}),
                               ".bvh", "", read_bvh_file, nullptr};
constexpr FormatFamily kFbx = {kinds_of({FileKind::kFbx}), ".fbx", "", read_scene_file, nullptr};
constexpr FormatFamily kGltf = {kinds_of({FileKind::kGltf}), ".glb .gltf .vrm .vrma", "",
                                read_scene_file, nullptr};
constexpr FormatFamily kMvnx = {kinds_of({FileKind::kMvnx}), ".mvnx", "", read_scene_file, nullptr};
// Pickles are often robot motions, so a batch reads them to find the human motions among them.
constexpr FormatFamily kArrays = {kinds_of({FileKind::kNpz, FileKind::kNpy, FileKind::kPickle,
                                            FileKind::kTorch, FileKind::kGzip}),
                                  ".npz .pt .npy", ".pkl .pickle .p .joblib", read_array_file,
                                  nullptr};
constexpr FormatFamily kCsv = {kinds_of({FileKind::kOther, FileKind::kForeign}), ".csv",
                               ".tsv .txt", nullptr, read_csv_motion};
constexpr FormatFamily kNpz = {kinds_of({FileKind::kNpz}), ".npz", "", nullptr, read_npz_motion};
constexpr FormatFamily kPickle = {kinds_of({FileKind::kPickle, FileKind::kGzip}),
                                  ".pkl .pickle .joblib", "", nullptr, read_pickle_motion};
constexpr FormatFamily kTorch = {kinds_of({FileKind::kTorch}), ".motion .pt", "", nullptr,
                                 read_protomotions};
constexpr FormatFamily kFolder = {0, "", "", nullptr, read_sonic_folder};
constexpr FormatFamily kShown = {kinds_of({FileKind::kGltf}), ".glb", "", nullptr, nullptr};

constexpr std::string_view kArrayFile = "`.npz`, `.npy`, `.pkl`, joblib, `.pt`";

constexpr std::string_view kCsvOptions =
    "precision csv-delimiter csv-header csv-quat csv-frame-column csv-degrees csv-centimetres";
constexpr std::string_view kPrinted = "precision";
constexpr std::string_view kTrackingOptions = "npz-fps npz-velocity";
constexpr std::string_view kNamed = "motion-name";
constexpr std::string_view kSonicOptions = "npz-fps npz-velocity motion-name";

constexpr Format kFormats[] = {
    {"bvh", kBvh, "`.bvh`", "LAFAN1, motion capture and animation programs", "bvh.md"},
    {"fbx", kFbx, "`.fbx`", "Mixamo, animation programs", "scenes.md"},
    {"gltf", kGltf, "`.glb`, `.gltf`, `.vrm`, `.vrma`", "glTF 2.0, VRM 0.x and 1.0", "scenes.md"},
    {"mvnx", kMvnx, "`.mvnx`", "Xsens MVN", "scenes.md"},
    {"smpl", kArrays, kArrayFile,
     "AMASS, OMOMO, AIST++, GVHMR, InterMimic, Motion-X, PHUMA, fits to video", "smpl.md"},
    {"positions", kArrays, kArrayFile, "HumanML3D, MDM, holosoma, Kimodo, your own programs",
     "positions.md"},

    {"csv", kCsv, "text, one line per frame",
     "BeyondMimic, mjlab, unitree_rl_lab, unitree_rl_mjlab, PBHC, viewers", "", "",
     MotionFormat::kCsv, ".csv", false, write_csv, nullptr, kCsvOptions},
    {"csv-soma", kCsv, "text with a header; centimetres, degrees, Euler angles",
     "programs for SOMA's and BONES-SEED's files", "", "", MotionFormat::kCsvSoma, ".soma.csv",
     false, write_csv, soma_csv_losses, kPrinted},
    {"npz-mjlab", kNpz, "arrays in MuJoCo's order", "mjlab's tracking task", "", "joint_pos",
     MotionFormat::kNpzMjlab, ".mjlab.npz", true, write_tracking_npz, nullptr, kTrackingOptions,
     true},
    {"npz-beyondmimic", kNpz, "arrays in Isaac Lab's order", "BeyondMimic (whole_body_tracking)",
     "", "joint_pos", MotionFormat::kNpzBeyondMimic, ".beyondmimic.npz", true, write_tracking_npz,
     nullptr, kTrackingOptions, true},
    {"npz-holosoma", kNpz, "arrays in MuJoCo's order, the root among the joints",
     "holosoma's whole-body tracking", "", "joint_pos", MotionFormat::kNpzHolosoma, ".holosoma.npz",
     true, write_tracking_npz, nullptr, kTrackingOptions, true},
    {"pkl-gmr", kPickle, "Python pickle", "programs for GMR's files: TWIST2, GMT and others", "",
     "dof_pos", MotionFormat::kPklGmr, ".gmr.pkl", false, write_gmr_pickle},
    {"pkl-pbhc", kPickle, "Python pickle", "PBHC, ASAP", "", "root_trans_offset",
     MotionFormat::kPklPbhc, ".pbhc.pkl", false, write_motion_lib_pickle, pbhc_losses, kNamed,
     true},
    {"pkl-motion-lib", kPickle, "Python pickle, all joints",
     "SONIC's training (GR00T-WholeBodyControl)", "", "root_trans_offset",
     MotionFormat::kPklMotionLib, ".motion-lib.pkl", false, write_motion_lib_pickle, nullptr,
     kNamed, true},
    {"pkl-mimickit", kPickle, "Python pickle", "MimicKit", "", "loop_mode",
     MotionFormat::kPklMimicKit, ".mimickit.pkl", false, write_mimickit_pickle},
    {"protomotions",
     kTorch,
     "`.motion`, a PyTorch file",
     "ProtoMotions",
     "",
     "rigid_body_pos",
     MotionFormat::kProtoMotions,
     ".motion",
     false,
     write_protomotions,
     nullptr,
     {},
     true},
    {"csv-sonic", kFolder, "a folder of CSVs", "SONIC's deployment (GR00T-WholeBodyControl)", "",
     "", MotionFormat::kCsvSonic, ".sonic", true, write_sonic_folder, sonic_losses, kSonicOptions},
    {"glb", kShown, "glTF 2.0, binary", "Blender, three.js, 3D viewers", "", "", MotionFormat::kGlb,
     ".glb", false, write_glb, nullptr, kNamed}};

// The command line uses the names of the table, in its order.
constexpr std::size_t kHumanFormats = 6;
static_assert(std::equal(std::begin(kFormats) + kHumanFormats, std::end(kFormats),
                         kEnumNames<MotionFormat>.begin(), kEnumNames<MotionFormat>.end(),
                         [](const Format& format, const auto& named) {
                           return format.name == named.second &&
                                  format.motion_format == named.first;
                         }));

bool contains(std::string_view words, std::string_view word) {
  while (!words.empty()) {
    if (take_until(words, ' ') == word) return true;
  }
  return false;
}

// Whether a batch treats the files of a format as robot motions, or as human motions.
bool is_searched(const Format& format, bool robots) {
  return robots ? format.family.read_robot != nullptr : format.family.read_human != nullptr;
}

bool is_searched_ending(std::string_view ending, bool robots) {
  return std::ranges::any_of(kFormats, [&](const Format& format) {
    return is_searched(format, robots) && contains(format.family.endings, ending);
  });
}

std::string endings_text(bool robots) {
  std::vector<std::string> found;
  for (const Format& format : kFormats) {
    std::string_view endings = is_searched(format, robots) ? format.family.endings : "";
    while (!endings.empty()) {
      const std::string_view ending = take_until(endings, ' ');
      if (std::ranges::find(found, ending) == found.end()) found.emplace_back(ending);
    }
  }
  const std::string last = std::move(found.back());
  found.pop_back();
  return fmt::format("{} or {}", fmt::join(found, ", "), last);
}

}  // namespace

std::span<const Format> all_formats() {
  return kFormats;
}

const Format& robot_format(MotionFormat format) {
  return *std::ranges::find_if(kFormats, [format](const Format& row) {
    return row.is_robots() && row.motion_format == format;
  });
}

std::vector<std::string> formats_with_option(std::string_view option) {
  std::vector<std::string> names;
  for (const Format& format : kFormats) {
    if (contains(format.options, option)) names.emplace_back(format.name);
  }
  return names;
}

std::string ending_of(const std::string& path) {
  return lower_case(std::filesystem::path(path).extension().string());
}

bool is_human_ending(std::string_view ending) {
  return is_searched_ending(ending, false);
}

bool is_robot_ending(std::string_view ending) {
  return is_searched_ending(ending, true);
}

bool may_be_human_ending(std::string_view ending) {
  return std::ranges::any_of(kFormats, [&](const Format& format) {
    return !format.is_robots() && contains(format.family.other_endings, ending);
  });
}

std::string human_endings_text() {
  return endings_text(false);
}

std::string robot_endings_text() {
  return endings_text(true);
}

std::string_view output_ending(std::string_view ending) {
  for (const Format& format : kFormats) {
    if (format.is_robots() && (contains(format.family.endings, ending) ||
                               contains(format.family.other_endings, ending))) {
      return format_ending(format.motion_format);
    }
  }
  return {};
}

std::string_view format_name(MotionFormat format) {
  return robot_format(format).name;
}

std::string_view format_ending(MotionFormat format) {
  std::string_view endings = robot_format(format).family.endings;
  return take_until(endings, ' ');
}

bool format_is_folder(MotionFormat format) {
  return format_ending(format).empty();
}

std::vector<std::string> folder_file_names(MotionFormat format) {
  return format_is_folder(format) ? sonic_file_names() : std::vector<std::string>();
}

bool format_has_own_rate(MotionFormat format) {
  return robot_format(format).own_rate;
}

int format_frame_count(const RobotClip& clip, MotionFormat format, const TrackingOptions& options) {
  return format_has_own_rate(format) ? tracking_frame_count(clip, format, options)
                                     : clip.frame_count();
}

RobotClip stored_clip(const RobotClip& clip, MotionFormat format, const TrackingOptions& options) {
  const Format& row = robot_format(format);
  const bool resampled = row.own_rate && !same_rate(options.rate, clip.rate());
  const int frames = resampled ? clip.frame_count() : format_frame_count(clip, format, options);
  // A motion that is too short for its format is an error of the writer only.
  RobotClip stored(clip.shared_robot(), clip.rate(),
                   std::clamp(frames, std::min(1, clip.frame_count()), clip.frame_count()));
  for (int frame = 0; frame < stored.frame_count(); ++frame) {
    const auto qpos = stored.qpos(frame);
    std::ranges::copy(clip.qpos(frame), qpos.begin());
    if (!row.is_float32 || resampled) continue;
    for (double& value : qpos) value = static_cast<float>(value);
  }
  return stored;
}

std::string_view format_long_ending(MotionFormat format) {
  return robot_format(format).long_ending;
}

std::vector<std::string> format_losses(const RobotClip& motion, MotionFormat format,
                                       const FrameRate& rate) {
  const Format& row = robot_format(format);
  return row.losses == nullptr ? std::vector<std::string>() : row.losses(motion, rate);
}

Result<std::vector<FormattedFile>> format_motion_files(const RobotClip& clip, MotionFormat format,
                                                       const WriteMotionOptions& options) {
  return robot_format(format).write(clip, format, options);
}

Result<std::string> format_robot_motion(const RobotClip& clip, MotionFormat format,
                                        const WriteMotionOptions& options) {
  if (format_is_folder(format)) {
    return usage_failure(std::string(format_name(format)) + " is a folder and not one file");
  }
  auto files = format_motion_files(clip, format, options);
  if (!files) return failure(std::move(files).error());
  return std::move(files->front().bytes);
}

}  // namespace retarget
