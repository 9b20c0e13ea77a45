#include "batch/find_inputs.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>

#include "batch/resume.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/file_endings.h"
#include "retarget/option_name.h"
#include "retarget/os.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// Memory of a clip: a multiple of its file size, and a constant. Measured with both methods,
// including quality measurement.
constexpr std::uint64_t kMemoryOfText = 8;
constexpr std::uint64_t kMemoryOfNpz = 20;
constexpr std::uint64_t kMemoryOfClip = std::uint64_t{16} << 20U;

}  // namespace

std::uint64_t memory_of_clip(std::string_view file, std::uint64_t bytes) {
  const std::string ending = lower_case(std::filesystem::path(file).extension().generic_string());
  const bool text = ending == ".bvh" || ending == ".csv";
  return kMemoryOfClip + bytes * (text ? kMemoryOfText : kMemoryOfNpz);
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPatternLetters = "*?[";
// Enough for millions of names; stops reading from an endless pipe.
constexpr std::size_t kMaxListBytes = std::size_t{256} << 20U;

constexpr const char* kMaybeOfRobots =
    RETARGET_OPTION("from-robot") " NAME accepts robot motions: .csv, .pkl, ...";

// Name of a folder, also with a trailing slash.
std::string name_of_folder(const fs::path& folder) {
  const std::string name =
      (folder / "").lexically_normal().parent_path().filename().generic_string();
  return name.empty() ? "." : name;
}

std::string list_endings(const std::set<std::string>& endings) {
  std::vector<std::string> names(endings.begin(), endings.end());
  for (std::string& name : names) name = name.empty() ? "no extension" : printable(name);
  return list_names(names, 8);
}

class InputFinder {
 public:
  explicit InputFinder(const InputSearch& search) : search_(search) {
    if (search.output_folder.empty()) return;
    if (const auto status = os::status_of(search.output_folder)) output_folder_ = status->id;
  }

  Result<FoundInputs> run();

 private:
  Result<void> add_name(const std::string& name);
  Result<void> add_pattern(const std::string& pattern);
  Result<void> add_list(const std::string& file);
  Result<void> add_existing(const std::string& path, const std::string& base, bool must_exist);
  void add_folder(const fs::path& folder, const std::string& relative);
  void add_entry(const fs::directory_entry& entry, const std::string& relative);
  void add_input(const std::string& path, const std::string& relative,
                 const std::optional<FileFacts>& facts);
  [[nodiscard]] bool is_motion(const std::string& name) const;
  [[nodiscard]] bool may_be_human_pickle(const std::string& path, const std::string& relative);
  [[nodiscard]] bool is_excluded(const std::string& relative);
  [[nodiscard]] Result<std::string> below(const std::string& path, const std::string& base) const;

  const InputSearch& search_;
  std::optional<os::FileId> output_folder_;
  std::vector<os::FileId> above_;  // The folder being read and its ancestors.
  FoundInputs found_;
  int hidden_ = 0, excluded_ = 0, others_ = 0;  // Numbers of files that are not inputs.
  std::set<std::string> other_endings_;         // Of the files that are not motions.
  std::set<std::string> used_patterns_;
};

bool InputFinder::is_excluded(const std::string& relative) {
  const std::string name = fs::path(relative).filename().generic_string();
  bool excluded = false;
  for (const std::string& pattern : search_.exclude) {
    if (!matches_pattern(pattern, relative) && !matches_pattern(pattern, name)) continue;
    used_patterns_.insert(pattern);
    excluded = true;
  }
  return excluded;
}

void InputFinder::add_input(const std::string& path, const std::string& relative,
                            const std::optional<FileFacts>& facts) {
  if (is_excluded(relative)) {
    ++excluded_;
    return;
  }
  BatchInput input{path, relative, 0, 0, {}, {}};
  if (facts) {
    input.bytes = facts->bytes;
    input.modified_ns = facts->modified_ns;
  }
  found_.inputs.push_back(std::move(input));
}

bool InputFinder::is_motion(const std::string& name) const {
  if (!search_.of_robots) return has_motion_ending(name);
  // Exclude other CSV files that a batch writes.
  return is_robot_ending(ending_of(name)) && !lower_case(name).ends_with(".contacts.csv") &&
         name != "summary.csv";
}

// Pickles that cannot be read become inputs that fail, so that missing clips are noticed. Excluded
// files are not read.
bool InputFinder::may_be_human_pickle(const std::string& path, const std::string& relative) {
  return !search_.of_robots && may_be_human_ending(ending_of(path)) &&
         (is_excluded(relative) || may_hold_human_motion(path, memory_share(0.0)));
}

void InputFinder::add_entry(const fs::directory_entry& entry, const std::string& relative) {
  const std::string path = entry.path().generic_string();
  const std::string name = entry.path().filename().generic_string();
  const std::string below_root = relative.empty() ? name : relative + "/" + name;
  const auto status = os::status_of(path);
  if (status && status->kind == os::EntryKind::kFolder) {
    add_folder(entry.path(), below_root);
    return;
  }
  const bool is_special = status && status->kind != os::EntryKind::kRegular;
  if (!is_motion(name) && (is_special || !may_be_human_pickle(path, below_root))) {
    if (name.starts_with('.')) return;
    ++others_;
    other_endings_.insert(ending_of(name));
    return;
  }
  if (name.starts_with("._")) {
    ++hidden_;
  } else if (!is_special) {
    // Includes dangling links, which fail when read, so that the missing clip is noticed.
    add_input(path, below_root, facts_of(path, FileUse::kInput));
  } else {
    found_.notes.push_back("skipped " + path + ": not a file");
  }
}

void InputFinder::add_folder(const fs::path& folder, const std::string& relative) {
  const auto status = os::status_of(folder.generic_string());
  if (!status) return;
  const os::FileId id = status->id;
  if (output_folder_ == id) {
    found_.notes.push_back("skipped " + folder.generic_string() + ": it is the output folder");
    return;
  }
  if (std::ranges::find(above_, id) != above_.end()) {
    found_.notes.push_back("skipped " + folder.generic_string() +
                           ": a link back to one of its parent folders");
    return;
  }
  if (search_.of_robots && is_sonic_folder(folder.generic_string())) {
    add_input(folder.generic_string(), relative.empty() ? name_of_folder(folder) : relative,
              facts_of(folder.generic_string(), FileUse::kInput));
    return;
  }
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  above_.push_back(id);
  while (!error && entries != fs::directory_iterator()) {
    add_entry(*entries, relative);
    entries.increment(error);
  }
  above_.pop_back();
  if (!error) return;
  found_.notes.push_back("cannot read the folder " + folder.generic_string() + ": " +
                         std::generic_category().message(error.value()));
  // Add it as an input that fails, so that its clips are not missed silently.
  add_input(folder.generic_string(), relative.empty() ? name_of_folder(folder) : relative,
            std::nullopt);
}

// The relative path of a single file.
Result<std::string> InputFinder::below(const std::string& path, const std::string& base) const {
  if (base.empty()) return fs::path(path).filename().generic_string();
  std::error_code ignored;
  const fs::path relative = fs::path(fs::absolute(path, ignored).lexically_normal())
                                .lexically_relative(fs::absolute(base, ignored).lexically_normal());
  if (relative.empty() || *relative.begin() == "..") {
    return usage_failure("\"" + path + "\" is not inside the folder \"" + base + "\"",
                         "give another " RETARGET_OPTION("relative-to") ", or omit it");
  }
  return relative.generic_string();
}

Result<void> InputFinder::add_existing(const std::string& path, const std::string& base,
                                       bool must_exist) {
  const auto status = os::status_of(path);
  if (!status && must_exist) {
    return input_failure(path, "no such file or folder: " + std::generic_category().message(errno));
  }
  if (status && status->kind == os::EntryKind::kFolder) {
    if (must_exist && output_folder_ == status->id) {
      return usage_failure("the folder of clips \"" + path + "\" is the output folder",
                           "give another folder with -o; it may be inside this one");
    }
    std::string relative;
    if (!base.empty()) {
      RETARGET_TRY_ASSIGN(const auto found, below(path, base));
      if (found != ".") relative = found;
      while (relative.ends_with('/')) relative.pop_back();
    }
    add_folder(path, relative);
    return {};
  }
  if (status && status->kind != os::EntryKind::kRegular) {
    return input_failure(path, "a batch reads regular files; this is a pipe or a device",
                         "retarget " RETARGET_OPTION("bvh") " reads one");
  }
  RETARGET_TRY_ASSIGN(const auto relative, below(path, base));
  add_input(path, relative, facts_of(path, FileUse::kInput));
  return {};
}

// Matches keep their path below the literal part of the pattern.
Result<void> InputFinder::add_pattern(const std::string& pattern) {
  const std::size_t first = pattern.find_first_of(kPatternLetters);
  const std::size_t slash = pattern.rfind('/', first);
  std::string base = slash == std::string::npos ? "." : pattern.substr(0, slash + 1);
  if (!search_.base.empty()) base = search_.base;
  const std::vector<std::string> matches = files_of_pattern(pattern);
  for (const std::string& match : matches) RETARGET_TRY(add_existing(match, base, false));
  if (!matches.empty()) return {};
  return input_failure(pattern, "no file matches this pattern",
                       "give the name of a folder to search it recursively");
}

Result<void> InputFinder::add_list(const std::string& file) {
  RETARGET_TRY_ASSIGN(const auto content, read_file(file, ErrorKind::kInput, kMaxListBytes));
  std::string_view text = without_byte_order_mark(content.view());
  const char end = text.find('\0') == std::string_view::npos ? '\n' : '\0';
  while (!text.empty()) {
    std::string_view line = take_until(text, end);
    if (end == '\n' && line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || (end == '\n' && line.starts_with('#'))) continue;
    RETARGET_TRY(add_existing(os::with_slashes(std::string(line)), search_.base, false));
  }
  return {};
}

Result<void> InputFinder::add_name(const std::string& name) {
  std::error_code ignored;
  // The name of an existing file takes precedence over `@` and patterns.
  const bool there = fs::exists(fs::symlink_status(name, ignored));
  if (!there && name.starts_with('@')) return add_list(name.substr(1));
  if (!there && name.find_first_of(kPatternLetters) != std::string::npos) return add_pattern(name);
  return add_existing(name, search_.base, true);
}

Result<FoundInputs> InputFinder::run() {
  for (const std::string& name : search_.names) {
    RETARGET_TRY(add_name(os::with_slashes(name)));
  }
  for (const std::string& list : search_.lists) {
    RETARGET_TRY(add_list(list));
  }
  if (hidden_ > 0) {
    found_.notes.push_back("skipped " + count_text(hidden_, "file") +
                           " named ._*, created by macOS archives");
  }
  if (excluded_ > 0) {
    found_.notes.push_back("skipped " + count_text(excluded_, "file") +
                           " because of " RETARGET_OPTION("exclude"));
  }
  if (others_ > 0 && !search_.of_robots) {
    found_.notes.push_back("skipped " + count_text(others_, "file") +
                           " without a human motion: " + list_endings(other_endings_));
  }
  for (const std::string& pattern : search_.exclude) {
    if (!used_patterns_.contains(pattern)) found_.unused_patterns.push_back(pattern);
  }
  if (found_.inputs.empty() && excluded_ > 0) {
    return input_failure(search_.names.empty() ? "" : search_.names.front(),
                         "all motion files are excluded",
                         "omit " RETARGET_OPTION("exclude") ", or make its patterns narrower");
  }
  if (found_.inputs.empty()) {
    return input_failure(search_.names.empty() ? "" : search_.names.front(),
                         search_.of_robots ? "no robot motion found: no " + robot_endings_text() +
                                                 " file and no SONIC folder"
                                           : "no motion found: no " + human_endings_text() +
                                                 " file, and no pickle of a human motion",
                         search_.of_robots ? "" : kMaybeOfRobots);
  }
  const auto key = [](const BatchInput& input) { return std::tie(input.relative, input.path); };
  std::ranges::sort(found_.inputs, {}, key);
  // Remove files named twice, for example directly and by their folder.
  const auto is_same = [](const BatchInput& a, const BatchInput& b) {
    std::error_code ignored;
    return a.relative == b.relative &&
           (a.path == b.path || fs::equivalent(a.path, b.path, ignored));
  };
  auto& inputs = found_.inputs;
  inputs.erase(std::unique(inputs.begin(), inputs.end(), is_same), inputs.end());
  return std::move(found_);
}

}  // namespace

std::string part_text(const std::string& start, const std::string& end) {
  return start.empty() && end.empty() ? std::string() : start + ":" + end;
}

PartOptions part_options(const std::string& part) {
  PartOptions options;
  if (part.empty()) return options;
  const std::size_t colon = part.find(':');
  const std::string start = part.substr(0, colon), end = part.substr(colon + 1);
  if (start.starts_with('f') || end.starts_with('f')) {
    const auto frame = [](const std::string& text) { return text.empty() ? text : text.substr(1); };
    options.frames = frame(start) + ":" + frame(end);
    return options;
  }
  options.start_s = parse_number<double>(start).value_or(-1.0);
  options.end_s = parse_number<double>(end).value_or(-1.0);
  return options;
}

std::string suffixed_name(const std::string& relative, const std::string& suffix) {
  const fs::path path(relative);
  const std::string name =
      path.stem().generic_string() + suffix + path.extension().generic_string();
  return path.has_parent_path() ? (path.parent_path() / name).generic_string() : name;
}

std::string mirrored_name(const std::string& relative) {
  return suffixed_name(relative, "_mirrored");
}

bool has_motion_ending(const std::string& name) {
  return is_human_ending(ending_of(name));
}

Result<FoundInputs> find_inputs(const InputSearch& search) {
  return InputFinder(search).run();
}

std::string output_stem(const std::string& relative) {
  const std::string ending = ending_of(relative);
  return is_human_ending(ending) || may_be_human_ending(ending) || is_robot_ending(ending)
             ? relative.substr(0, relative.size() - ending.size())
             : relative;
}

Result<void> check_distinct_outputs(std::span<const BatchInput> inputs) {
  std::map<std::string, const BatchInput*> taken;
  int clashes = 0;
  bool by_image = false, in_one_folder = false;
  std::string first;
  for (const BatchInput& input : inputs) {
    const std::string stem = output_stem(input.relative);
    const auto [at, is_new] = taken.emplace(stem, &input);
    if (is_new) continue;
    if (clashes++ == 0) {
      by_image = at->second->variant.is_mirrored() || input.variant.is_mirrored();
      in_one_folder = fs::path(output_stem(at->second->path)).lexically_normal() ==
                      fs::path(output_stem(input.path)).lexically_normal();
      first = "\"" + at->second->path + "\" and \"" + input.path + "\" would both become \"" +
              stem + "\"";
    }
  }
  if (clashes == 0) return {};
  if (clashes > 1) first += ", and " + std::to_string(clashes - 1) + " more conflicts";
  if (by_image) {
    return usage_failure(
        first,
        "rename the file that conflicts with " RETARGET_OPTION(
            "mirror") ", exclude it with " RETARGET_OPTION("exclude") ", or omit " RETARGET_OPTION("mirror"));
  }
  if (in_one_folder) {
    return usage_failure(first, "rename one or exclude it with " RETARGET_OPTION("exclude"));
  }
  return usage_failure(first,
                       "give only the folder that contains both, or " RETARGET_OPTION("relative-to") " FOLDER "
                       "to keep the tree below "
                       "it; otherwise rename one or exclude it with " RETARGET_OPTION("exclude"));
}

}  // namespace retarget
