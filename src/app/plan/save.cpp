#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/plan/motion_target.h"
#include "base/option_name.h"
#include "base/try.h"
#include "formats/registry/format.h"
#include "retarget/file.h"
#include "retarget/motion.h"
#include "retarget/motion_io.h"
#include "retarget/normalize_start.h"
#include "retarget/option_table.h"
#include "retarget/options.h"
#include "retarget/os.h"
#include "retarget/run.h"
#include "retarget/scene.h"
#include "retarget/solve.h"
#include "retarget/solved_scene.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Human and contacts refer to the frames of the motion.
struct SavedMotion {
  const RobotClip& clip;
  std::optional<HumanInWorld> human;
  std::optional<FootContacts> contacts;
  std::optional<SceneClip> scene;
  std::optional<ContactLabels> labels;
  const LimitSet* limits;  // Null: the robot's default set.
  StartNormalizer start;
  bool is_converted = false;
};

Result<void> save_with(SavedMotion motion, const std::string& output, const SaveOptions& options) {
  TRY_ASSIGN(const auto items, plan_outputs(output, options));
  TRY_ASSIGN(const std::string reference, reference_path(output, options));
  WriteMotionOptions write = write_options(output, options);
  if (motion.is_converted) {
    write.tracking = conversion_options(write.tracking, motion.clip.rate());
  }
  write.human = std::move(motion.human);
  write.contacts = std::move(motion.contacts);
  write.scene = std::move(motion.scene);
  write.labels = std::move(motion.labels);
  RobotClip moved = motion.clip;
  if (options.normalize_start) normalize_start(motion.start, moved, write);
  std::vector<MotionTarget> targets;
  for (const OutputItem& item : items) {
    TRY_ASSIGN(MotionTarget target, MotionTarget::create(item));
    TRY_ASSIGN(const auto files, format_motion_files(moved, item.format, write));
    TRY(target.write(files));
    targets.push_back(std::move(target));
  }
  TRY_ASSIGN(FilesBeside others,
             write_files_beside(reference, moved, write, options, motion.limits));
  // Commit all files together after they are written.
  for (MotionTarget& target : targets) TRY(target.commit());
  for (OutputFile& file : others.files) TRY(file.commit());
  return {};
}

}  // namespace

Result<void> save(const RobotClip& clip, const std::string& output, const SaveOptions& options) {
  return save_with({clip, std::nullopt, std::nullopt, std::nullopt, std::nullopt, nullptr,
                    StartNormalizer(clip), true},
                   output, options);
}

Result<void> save(const Motion& motion, const std::string& output,
                  const std::optional<SaveOptions>& options) {
  SavedMotion saved{
      motion.clip,         human_in_world(*motion.source, motion.plan.human.calibration),
      contacts_of(motion), std::nullopt,
      std::nullopt,        &motion.plan.limits,
      start_of(motion)};
  if (motion.scene) {
    saved.scene = motion.scene->clip;
    saved.labels = contact_labels(motion);
  }
  return save_with(std::move(saved), output, options.value_or(motion.plan.options.save));
}

namespace fs = std::filesystem;

namespace {

// Extensions of files that are not robot motions, besides those of human motions.
constexpr std::string_view kForeignEndings[] = {".json", ".jsonl", ".xml",  ".urdf", ".html",
                                                ".zip",  ".gz",    ".xlsx", ".hdf5", ".h5"};

bool is_foreign(std::string_view ending) {
  return std::ranges::find(kForeignEndings, ending) != std::end(kForeignEndings) ||
         (is_human_ending(ending) && output_ending(ending) != ending);
}

// Extensions of pictures and documents, which only some outputs are.
constexpr std::string_view kShownEndings[] = {".png",  ".svg", ".pgm", ".pdf", ".jpg", ".jpeg",
                                              ".webp", ".gif", ".mp4", ".htm", ".md",  ".yaml"};

// Whether an extension belongs to some kind of file that retarget or other programs know.
bool is_of_known_kind(std::string_view ending) {
  return is_foreign(ending) || is_human_ending(ending) || is_robot_ending(ending) ||
         std::ranges::find(kShownEndings, ending) != std::end(kShownEndings);
}

std::string formats_ending_in(std::string_view ending) {
  std::vector<std::string> names;
  for (const Format& format : all_formats()) {
    if (format.is_robots() && format_ending(format.motion_format) == ending) {
      names.emplace_back(format.name);
    }
  }
  return list_names(names);
}

Result<MotionFormat> only_format(const std::string& output, const SaveOptions& options) {
  if (!options.formats.empty()) return options.formats.front();
  const std::string_view kind = output_ending(ending_of(output));
  if (kind.empty() || kind == format_ending(MotionFormat::kCsv)) return MotionFormat::kCsv;
  for (const MotionFormat format : {MotionFormat::kGlb, MotionFormat::kProtoMotions}) {
    if (kind == format_ending(format)) return format;
  }
  return usage_failure("the output \"" + output +
                           "\" matches several formats, and " OPTION("format") " is not given",
                       "add " OPTION("format") " with one of: " + formats_ending_in(kind));
}

Result<void> check_ending(const OutputItem& item) {
  const std::string ending = ending_of(item.path);
  const std::string_view kind = output_ending(ending);
  if (item.path == "-" && format_is_folder(item.format)) {
    return usage_failure(OPTION("format") " " + std::string(format_name(item.format)) +
                             " writes a folder and cannot use standard output",
                         "name a folder with " OPTION("output"));
  }
  if (!is_foreign(ending) && (kind.empty() || kind == format_ending(item.format))) return {};
  return usage_failure(
      "the output \"" + item.path + "\" ends in " + fs::path(item.path).extension().string() +
          ", and " OPTION("format") " " + std::string(format_name(item.format)) + " makes a " +
          (format_is_folder(item.format) ? std::string("folder")
                                         : std::string(format_ending(item.format)) + " file"),
      "give a name that matches the format");
}

// Rejects options that change only formats that are not written.
Result<void> check_used(SaveOptions options, const std::vector<OutputItem>& items) {
  SaveOptions default_options;
  for (const std::string& name :
       changed_options(save_table(options), save_table(default_options))) {
    const std::vector<std::string> users = formats_with_option(name);
    const auto uses = [&](const OutputItem& item) {
      return std::ranges::count(users, format_name(item.format)) > 0;
    };
    if (users.empty() || std::ranges::any_of(items, uses)) continue;
    return usage_failure(
        marked_option(name) + " has no effect on " + std::string(format_name(items.front().format)),
        "it applies to " + list_names(users));
  }
  return {};
}

Result<std::vector<OutputItem>> items_of(const std::string& output, const SaveOptions& options) {
  if (output.empty()) {
    return usage_failure("no output is given",
                         "add " OPTION("output") " FILE, or - for standard output");
  }
  if (options.formats.size() <= 1) {
    TRY_ASSIGN(const MotionFormat format, only_format(output, options));
    OutputItem item{format, output};
    // A trailing slash names the same folder.
    if (format_is_folder(format)) item.path = os::without_last_separators(item.path);
    TRY(check_ending(item));
    return std::vector<OutputItem>{std::move(item)};
  }
  if (output == "-") {
    return usage_failure("several formats cannot share standard output",
                         "name a file with " OPTION("output"));
  }
  std::string base = output;
  const std::string given = ending_of(base);
  if (!given.empty() && output_ending(given) == given) base.erase(base.size() - given.size());
  std::vector<OutputItem> items;
  for (const MotionFormat format : options.formats) {
    if (std::ranges::find(items, format, &OutputItem::format) != items.end()) {
      return usage_failure(OPTION("format") " names " + std::string(format_name(format)) +
                           " twice");
    }
    items.push_back({format, base + std::string(format_long_ending(format))});
  }
  return items;
}

}  // namespace

Result<void> check_output_ending(const std::string& path,
                                 std::initializer_list<std::string_view> endings,
                                 const std::string& kind) {
  const std::string ending = ending_of(path);
  if (std::ranges::find(endings, ending) != endings.end() || !is_of_known_kind(ending)) return {};
  const std::vector<std::string> names(endings.begin(), endings.end());
  return usage_failure("unsupported extension " + fs::path(path).extension().string() +
                           " of the output \"" + path + "\", which is " + kind,
                       (names.size() > 1 ? "use one of " : "use ") + list_names(names));
}

Result<std::vector<OutputItem>> plan_outputs(const std::string& output,
                                             const SaveOptions& options) {
  TRY_ASSIGN(auto items, items_of(output, options));
  TRY(check_used(options, items));
  return items;
}

FrameRate rate_of_format(MotionFormat format, const SaveOptions& options, const FrameRate& motion) {
  return format_has_own_rate(format) ? FrameRate{options.npz_fps, 1} : motion;
}

std::vector<FrameRate> solved_rates(const SaveOptions& options, Method method,
                                    const FrameRate& motion) {
  const auto has_motions = [](MotionFormat format) { return !format_has_own_rate(format); };
  std::vector<FrameRate> rates;
  if (method != Method::kFit || options.formats.empty() ||
      std::ranges::any_of(options.formats, has_motions)) {
    rates.push_back(motion);
  }
  if (method != Method::kFit) return rates;
  for (const MotionFormat format : options.formats) {
    const FrameRate rate = rate_of_format(format, options, motion);
    const bool known =
        std::ranges::any_of(rates, [&](const FrameRate& one) { return same_rate(one, rate); });
    if (!known) rates.push_back(rate);
  }
  return rates;
}

namespace {

RobotCsvOptions csv_options(const SaveOptions& options) {
  RobotCsvOptions csv;
  csv.precision = options.precision;
  csv.delimiter = options.delimiter == Delimiter::kComma   ? ','
                  : options.delimiter == Delimiter::kSpace ? ' '
                                                           : '\t';
  csv.header = options.header;
  csv.quaternion_order = options.quaternion;
  csv.frame_column = options.frame_column;
  csv.degrees = options.degrees;
  csv.centimetres = options.centimetres;
  return csv;
}

}  // namespace

std::vector<RobotCsvOptions> csv_layouts(const SaveOptions& options, const FrameRate& rate) {
  const auto& formats = options.formats;
  const auto writes = [&](MotionFormat format) {
    return std::ranges::find(formats, format) != formats.end();
  };
  std::vector<RobotCsvOptions> layouts;
  if (formats.empty() || writes(MotionFormat::kCsv)) layouts.push_back(csv_options(options));
  if (writes(MotionFormat::kCsvSoma)) layouts.push_back(soma_csv_options(rate, options.precision));
  return layouts;
}

WriteMotionOptions write_options(const std::string& output, const SaveOptions& options) {
  WriteMotionOptions write;
  write.csv = csv_options(options);
  write.tracking.rate = {options.npz_fps, 1};
  write.tracking.velocity_of = options.npz_velocity;
  write.name = options.motion_name;
  if (write.name.empty() && output != "-") write.name = name_of_motion(output);
  return write;
}

std::string name_of_motion(const std::string& output) {
  std::string file = fs::path(os::without_last_separators(output)).filename().string();
  const std::string lower = lower_case(file);
  const std::string ending = ending_of(file);
  std::size_t longest = output_ending(ending).empty() ? 0 : ending.size();
  for (const Format& format : all_formats()) {
    if (lower.ends_with(format.long_ending)) longest = std::max(longest, format.long_ending.size());
  }
  if (longest < file.size()) file.erase(file.size() - longest);
  return file;
}

}  // namespace retarget
