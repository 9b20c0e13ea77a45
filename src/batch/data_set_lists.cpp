// The lists of a batch: passed.txt, failed.tsv, duplicates.tsv and those of a split.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "batch/data_set.h"
#include "batch/split.h"
#include "retarget/file.h"
#include "retarget/option_name.h"
#include "retarget/os.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Names with line ends would break a list.
bool fits_line(const std::string& name) {
  return name.find_first_of("\r\n") == std::string::npos;
}

std::string cell_of(const std::string& text) {
  std::string cell;
  // Prevent spreadsheets from interpreting the cell as a formula.
  if (!text.empty() && std::string_view("=+-@").find(text.front()) != std::string_view::npos) {
    cell = "'";
  }
  for (const char c : text) cell += c == '\t' || c == '\r' || c == '\n' ? ' ' : c;
  return cell;
}

// A sorted list of files, one per line.
class FileList {
 public:
  void add(const ManifestEntry& entry) {
    for (const std::string& file : motions_of(entry)) files_.insert(file);
  }
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const std::string& file : files_) text += file + "\n";
    return text;
  }

 private:
  std::set<std::string> files_;
};

// The lists of a batch, and how many clips they contain.
class BatchLists {
 public:
  // @param check_files  DataSetRules::check_files.
  BatchLists(const std::string& folder, bool check_files)
      : folder_(folder), check_files_(check_files) {}

  void add(const ManifestEntry& entry);
  [[nodiscard]] Result<void> write(bool with_duplicates) const;
  // Reports the clips that are not listed although they passed, and the number of clips.
  void report(std::size_t all, Observer& observer) const;
  [[nodiscard]] const std::vector<const ManifestEntry*>& passed() const { return passed_; }

 private:
  void add_passed(const ManifestEntry& entry);

  const std::string& folder_;
  const bool check_files_;
  FileList files_;
  std::vector<const ManifestEntry*> passed_;
  std::string failed_ = "file\treason\trobot\n";
  std::string repeated_ = "file\tof\tkind\tdistance_deg\trobot\n";
  std::size_t missing_ = 0, repeating_ = 0, failing_ = 0;
  std::size_t with_line_break_ = 0;
  std::vector<std::string> gone_;  // One missing file per clip.
};

void BatchLists::add_passed(const ManifestEntry& entry) {
  const std::vector<std::string> motions = motions_of(entry);
  if (!std::ranges::all_of(motions, fits_line)) {
    ++with_line_break_;
    return;
  }
  const auto is_gone = [&](const std::string& file) {
    return !os::status_of(folder_ + "/" + file).has_value();
  };
  const auto gone = check_files_ ? std::ranges::find_if(motions, is_gone) : motions.end();
  if (gone != motions.end()) {
    gone_.push_back(*gone);
    return;
  }
  files_.add(entry);
  passed_.push_back(&entry);
}

void BatchLists::add(const ManifestEntry& entry) {
  if (has_passed(entry)) {
    add_passed(entry);
  } else if (entry.repeated) {
    ++repeating_;
    repeated_ +=
        fmt::format("{}\t{}\t{}\t{:.2f}\t{}\n", cell_of(entry.relative),
                    cell_of(entry.repeated->of), entry.repeated->mirrored ? "mirrored" : "same",
                    entry.repeated->distance, cell_of(entry.robot));
  } else {
    ++(entry.done ? missing_ : failing_);
    failed_ += fmt::format("{}\t{}\t{}\n", cell_of(entry.relative), cell_of(reason_of(entry)),
                           cell_of(entry.robot));
  }
}

Result<void> BatchLists::write(bool with_duplicates) const {
  RETARGET_TRY(write_file(folder_ + "/passed.txt", files_.text()));
  RETARGET_TRY(write_file(folder_ + "/failed.tsv", failed_));
  const std::string duplicates = folder_ + "/duplicates.tsv";
  std::error_code ignored;
  if (!with_duplicates && repeating_ == 0 && !fs::exists(duplicates, ignored)) return {};
  return write_file(duplicates, repeated_);
}

void BatchLists::report(std::size_t all, Observer& observer) const {
  constexpr std::size_t kNamedGone = 3;
  const std::string path = folder_ + "/passed.txt";
  if (with_line_break_ > 0) {
    observer.warn({{0, 0,
                    count_text(with_line_break_, "clip") +
                        " with a line break in the name cannot be listed and " +
                        (with_line_break_ == 1 ? "is" : "are") + " skipped"}},
                  path);
  }
  if (!gone_.empty()) {
    observer.warn({{0, 0,
                    count_text(gone_.size(), "clip") +
                        (gone_.size() == 1 ? " is not listed, because its file is missing: "
                                           : " are not listed, because their files are missing: ") +
                        list_names(gone_, kNamedGone) +
                        "; the batch with " RETARGET_OPTION("resume") " restores " +
                        (gone_.size() == 1 ? "it" : "them")}},
                  path);
  }
  std::string text = fmt::format("{} of {} in {}", passed_.size(), count_text(all, "clip"), path);
  if (missing_ > 0) {
    text += fmt::format("; {} {} a gate", missing_, missing_ == 1 ? "misses" : "miss");
  }
  if (failing_ > 0) text += fmt::format("; {} failed", failing_);
  if (repeating_ > 0) {
    text += fmt::format("; {} {}, see duplicates.tsv", repeating_,
                        repeating_ == 1 ? "repeats another" : "repeat others");
  }
  observer.line("passed", text);
}

// A set with the name of its list and its purpose for messages.
struct SplitList {
  SplitSide side;
  const char* file;
  const char* purpose;
};
constexpr std::array kSplitLists = {
    SplitList{SplitSide::kTrain, "train.txt", "training"},
    SplitList{SplitSide::kValidation, "validation.txt", "validation"},
    SplitList{SplitSide::kTest, "test.txt", "testing"}};

void warn_of_old_list(const std::string& path, Observer& observer) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return;
  observer.warn({{0, 0,
                  "this list is from an earlier call and was not updated; " RETARGET_OPTION(
                      "split") " updates it"}},
                path);
}

std::string rule_text(const SplitGroups& groups) {
  std::string rule = groups.by_subject == 0 ? "no file name identifies a subject: "
                                            : count_text(groups.by_subject, "group") +
                                                  " by the subject in the file names";
  if (groups.by_file > 0) {
    rule += (groups.by_subject == 0 ? "" : ", ") + count_text(groups.by_file, "group") + " by file";
  }
  if (groups.joined > 0) {
    rule += fmt::format("; {} joined with others that have the same input or its mirror image",
                        count_text(groups.joined, "group"));
  }
  return rule;
}

// Without signatures, mirror images under other names are not recognised.
void note_unsigned(const std::vector<const ManifestEntry*>& passed, Observer& observer) {
  const auto count = std::ranges::count_if(passed, [](const ManifestEntry* entry) {
    return !entry->variant.is_derived() && entry->signature.empty();
  });
  if (count == 0) return;
  observer.line("", "mirror images of " + count_text(count, "clip") +
                        " are identified only by their names; " RETARGET_OPTION(
                            "resume") " with " RETARGET_OPTION("split") " compares the motions");
}

Result<void> write_split(const std::string& folder, const std::vector<const ManifestEntry*>& passed,
                         const Split& split, Observer& observer) {
  const SplitGroups groups = split_groups(passed);
  RETARGET_TRY_ASSIGN(const std::vector<SplitSide> sides, split_clips(groups.keys, split));
  std::string text;
  for (const SplitList& list : kSplitLists) {
    const std::string path = folder + "/" + list.file;
    if (list.side == SplitSide::kTest && split.test <= 0.0) {
      warn_of_old_list(path, observer);
      continue;
    }
    FileList files;
    std::set<std::string_view> keys;
    std::size_t clips = 0;
    for (std::size_t i = 0; i < passed.size(); ++i) {
      if (sides[i] != list.side) continue;
      files.add(*passed[i]);
      keys.insert(groups.keys[i]);
      ++clips;
    }
    RETARGET_TRY(write_file(path, files.text()));
    text += fmt::format("{}{} of {} for {}", text.empty() ? "" : ", ", count_text(clips, "clip"),
                        count_text(keys.size(), "group"), list.purpose);
  }
  observer.line("split", text);
  if (passed.empty()) return {};
  observer.line("", rule_text(groups));
  note_unsigned(passed, observer);
  return {};
}

// Warns of lists from an earlier call that this call does not update.
void warn_of_old_lists(const std::string& folder, Observer& observer) {
  for (const SplitList& list : kSplitLists) warn_of_old_list(folder + "/" + list.file, observer);
}

}  // namespace

Result<void> write_lists(const std::string& folder, const std::vector<ManifestEntry>& entries,
                         const DataSetRules& rules, Observer& observer) {
  BatchLists lists(folder, rules.check_files);
  for (const ManifestEntry& entry : entries) lists.add(entry);
  RETARGET_TRY(lists.write(rules.dedupe == true));
  lists.report(entries.size(), observer);
  if (!rules.split) {
    warn_of_old_lists(folder, observer);
    return {};
  }
  return write_split(folder, lists.passed(), *rules.split, observer);
}

}  // namespace retarget
