#include "batch/manifests.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <regex>
#include <system_error>
#include <tuple>
#include <utility>

#include "batch/batch_report.h"
#include "batch/merge_checks.h"
#include "batch/output_owners.h"
#include "batch/output_tree.h"
#include "retarget/file.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStem = "manifest";
constexpr const char* kFileEnding = ".jsonl";
constexpr std::size_t kNamedWorst = 3;

Result<std::vector<ManifestEntry>> read_entries(const std::string& path, Observer& observer) {
  RETARGET_TRY_ASSIGN(auto content, read_manifest(path));
  if (content.unreadable > 0) {
    observer.line("manifest",
                  path + ": " + count_text(content.unreadable, "line") + " ignored: unreadable");
  }
  if (content.outside > 0) {
    observer.warn({{0, 0,
                    count_text(content.outside, "line") + " with a name that is not inside the " +
                        "output folder, such as \"" + content.outside_name +
                        "\", ignored: batches do not write such names"}},
                  path);
  }
  return std::move(content.entries);
}

// Matches manifests of a whole batch or of a shard; other files belong to the user.
bool is_manifest_name(const std::string& name) {
  static const std::regex kNames(R"(manifest(\.[1-9][0-9]*-of-[1-9][0-9]*)?\.jsonl)");
  return std::regex_match(name, kNames);
}

// The other manifests in a folder, sorted.
std::vector<std::string> manifests_beside(const std::string& folder, const std::string& own) {
  std::vector<std::string> found;
  for (const fs::path& file : files_in_folder(folder)) {
    const bool is_manifest = is_manifest_name(file.filename().generic_string());
    if (is_manifest && file != own) found.push_back(file.generic_string());
  }
  return found;
}

void append_to(std::vector<ManifestEntry>& all, std::vector<ManifestEntry> more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

Result<std::vector<ManifestEntry>> read_all_entries(const std::vector<std::string>& paths,
                                                    Observer& observer) {
  std::vector<ManifestEntry> entries;
  for (const std::string& path : paths) {
    RETARGET_TRY_ASSIGN(auto more, read_entries(path, observer));
    append_to(entries, std::move(more));
  }
  return entries;
}

std::string lines_of(const std::vector<ManifestEntry>& entries) {
  std::string text;
  for (const ManifestEntry& entry : entries) text += manifest_line(entry);
  return text;
}

std::size_t failed_among(const std::vector<ManifestEntry>& entries) {
  return static_cast<std::size_t>(std::ranges::count_if(entries, &ManifestEntry::has_failed));
}

// Reports the worst clips.
void print_worst(const std::vector<ManifestEntry>& entries, Observer& observer) {
  std::vector<const ManifestEntry*> missed;
  for (const ManifestEntry& entry : entries) {
    if (entry.done && entry.quality && !entry.quality->missed.empty()) missed.push_back(&entry);
  }
  const auto measured = std::ranges::count_if(
      entries, [](const ManifestEntry& entry) { return entry.quality.has_value(); });
  if (measured == 0) return;
  observer.line("quality", std::to_string(missed.size()) + " of " + count_text(measured, "motion") +
                               " missed a gate");
  std::ranges::stable_sort(missed, std::ranges::greater{}, [](const ManifestEntry* entry) {
    return std::pair(entry->quality->missed.size(), entry->quality->worst_ratio);
  });
  for (std::size_t i = 0; i < std::min(kNamedWorst, missed.size()); ++i) {
    const ManifestEntry& entry = *missed[i];
    observer.line(i == 0 ? "worst" : "", entry.relative + " on " + entry.robot + ": " +
                                             count_text(entry.quality->missed.size(), "gate") +
                                             " missed, worst " + entry.quality->worst);
  }
}

Result<void> write_summary(const std::string& folder, const std::vector<ManifestEntry>& entries,
                           Observer& observer) {
  const std::string path = folder + "/summary.csv";
  RETARGET_TRY(write_file(path, summary_csv(entries)));
  print_worst(entries, observer);
  observer.line("wrote", path + ", the worst clips first");
  return {};
}

// Warns of clips without signatures, whose duplicates are not recognised.
void warn_of_unsigned(const std::vector<ManifestEntry>& entries, const std::string& path,
                      Observer& observer) {
  const auto count = std::ranges::count_if(entries, [](const ManifestEntry& entry) {
    return entry.done && !entry.variant.is_derived() && entry.signature.empty();
  });
  if (count == 0) return;
  observer.warn(
      {{0, 0,
        count_text(static_cast<std::size_t>(count), "clip") + (count == 1 ? " has" : " have") +
            " no signature for finding duplicates: run the batch with " RETARGET_OPTION(
                "dedupe") " and " RETARGET_OPTION("resume")}},
      path);
}

}  // namespace

Result<Shard> parse_shard(const std::string& text) {
  Shard shard;
  const char* const end = text.data() + text.size();
  const auto [slash, bad_index] = std::from_chars(text.data(), end, shard.index);
  if (bad_index == std::errc() && slash != end && *slash == '/') {
    const auto [rest, bad_count] = std::from_chars(slash + 1, end, shard.count);
    const bool in_range = shard.index >= 1 && shard.index <= shard.count;
    if (bad_count == std::errc() && rest == end && in_range) return shard;
  }
  return usage_failure(
      RETARGET_OPTION("shard") " must be I/N with I from 1 to N, found \"" + text + "\"",
      RETARGET_OPTION("shard") " 1/4 selects the first of four parts");
}

void sort_longest_first(std::vector<BatchInput>& inputs) {
  std::ranges::sort(inputs, [](const BatchInput& a, const BatchInput& b) {
    return std::tie(b.bytes, a.relative, a.path) < std::tie(a.bytes, b.relative, b.path);
  });
}

std::vector<BatchInput> take_shard(std::vector<BatchInput> inputs, const Shard& shard) {
  sort_longest_first(inputs);
  std::vector<BatchInput> taken;
  for (auto i = static_cast<std::size_t>(shard.index - 1); i < inputs.size();
       i += static_cast<std::size_t>(shard.count)) {
    taken.push_back(std::move(inputs[i]));
  }
  return taken;
}

std::string shard_file_name(const std::string& stem, const Shard& shard, const std::string& end) {
  if (shard.count == 1) return stem + end;
  return stem + "." + std::to_string(shard.index) + "-of-" + std::to_string(shard.count) + end;
}

bool has_manifest(const std::string& folder) {
  return !manifests_beside(folder, {}).empty();
}

Result<BatchManifests> open_manifests(const std::string& folder, const Shard& shard,
                                      const BatchRequest& request, Observer& observer) {
  BatchManifests manifests;
  manifests.path = folder + "/" + shard_file_name(kStem, shard, kFileEnding);
  const std::string whole = folder + "/" + kStem + kFileEnding;
  std::error_code ignored;
  manifests.is_new = !has_manifest(folder);
  if (request.redo) {
    if (shard.count > 1) return manifests;
    for (const std::string& other : manifests_beside(folder, {})) {
      // A damaged one names no files.
      if (auto content = read_manifest(other)) {
        append_to(manifests.discarded, std::move(content->entries));
      }
      if (other != whole) fs::remove(other, ignored);
    }
    return manifests;
  }
  if (!request.resume) {
    std::vector<std::string> there = {manifests.path, whole};
    if (shard.count == 1) there = manifests_beside(folder, {});
    for (const std::string& path : there) {
      if (!fs::exists(path, ignored)) continue;
      return usage_failure(
          path + " exists: the folder already holds a batch",
          RETARGET_OPTION("resume") " continues it, " RETARGET_OPTION("redo") " starts over");
    }
    return manifests;
  }
  RETARGET_TRY_ASSIGN(manifests.own, read_entries(manifests.path, observer));
  RETARGET_TRY_ASSIGN(manifests.others,
                      read_all_entries(manifests_beside(folder, manifests.path), observer));
  return manifests;
}

bool clip_is_gone(const ManifestEntry& entry, const std::set<std::string>& known) {
  if (known.contains(entry.relative)) return false;
  std::error_code ignored;
  return !fs::exists(fs::symlink_status(entry.input.file, ignored));
}

bool is_gone(const ManifestEntry& entry, const std::set<std::string>& known) {
  return !entry.done && clip_is_gone(entry, known);
}

Result<void> finish_manifests(const std::string& folder, const Shard& shard,
                              const BatchSelection& selection, const DataSetRules& rules,
                              Observer& observer) {
  const std::string path = folder + "/" + shard_file_name(kStem, shard, kFileEnding);
  RETARGET_TRY_ASSIGN(std::vector<ManifestEntry> entries, read_entries(path, observer));
  std::vector<std::string> parts;
  if (shard.count == 1) parts = manifests_beside(folder, path);
  RETARGET_TRY_ASSIGN(auto of_parts, read_all_entries(parts, observer));
  append_to(entries, std::move(of_parts));
  entries = latest_entries(std::move(entries));
  std::erase_if(entries,
                [&](const ManifestEntry& entry) { return is_gone(entry, selection.clips); });
  remove_replaced_entries(entries, path, observer);
  judge_entries(entries, rules, &selection.clips);
  RETARGET_TRY(write_file(path, lines_of(entries)));
  // The merged manifest is on disk, so the parts are no longer needed.
  std::error_code ignored;
  for (const std::string& part : parts) fs::remove(part, ignored);
  observer.line("wrote", path);
  if (shard.count > 1) {
    if (rules.split) {
      observer.line("split", "the lists are written when the parts are merged");
    }
    return {};
  }
  RETARGET_TRY(write_summary(folder, entries, observer));
  // Clips and robots of other calls do not belong to this call's data set.
  const std::size_t unrequested = std::erase_if(
      entries, [&](const ManifestEntry& entry) { return !selection.contains(entry); });
  if (unrequested > 0) {
    observer.line("lists", count_text(unrequested, "clip") + " of the manifest " +
                               (unrequested == 1 ? "is" : "are") +
                               " not part of this call and not listed");
  }
  return write_lists(folder, entries, rules, observer);
}

Result<std::size_t> merge_manifests(const std::string& folder,
                                    const std::vector<std::string>& further,
                                    const DataSetRules& rules, Observer& observer) {
  const std::string path = folder + "/" + kStem + kFileEnding;
  const std::vector<std::string> parts = manifests_beside(folder, path);
  std::error_code ignored;
  std::vector<std::string> others = parts;
  for (const std::string& name : further) {
    if (!fs::exists(name, ignored)) return input_failure(name, "no such manifest");
    others.push_back(name);
  }
  // For equal times, later entries take precedence: parts are newer than the whole.
  const bool has_whole = fs::exists(path, ignored);
  RETARGET_TRY_ASSIGN(std::vector<ManifestEntry> entries, read_entries(path, observer));
  RETARGET_TRY_ASSIGN(auto of_others, read_all_entries(others, observer));
  const MissingShards missing = missing_shards(others, entries, of_others);
  append_to(entries, std::move(of_others));
  if (entries.empty()) return input_failure(folder, "no batch manifest to merge");
  entries = latest_entries(std::move(entries));
  remove_replaced_entries(entries, path, observer);
  judge_entries(entries, rules);
  if (rules.dedupe == true) warn_of_unsigned(entries, path, observer);
  warn_of_mixed_options(entries, path, observer);
  warn_of_missing_shards(missing, folder, observer);
  RETARGET_TRY(write_file(path, lines_of(entries)));
  // The merged manifest is on disk. The parts are needed only to find the missing ones next time.
  for (const std::string& part : parts) {
    if (missing.count == 0) fs::remove(part, ignored);
  }
  remove_unfinished(folder, output_folders(folder, entries));
  const std::size_t failed = failed_among(entries);
  observer.line("merged", count_text(others.size() + (has_whole ? 1 : 0), "manifest") + ", " +
                              count_text(entries.size(), "clip") + ", " + std::to_string(failed) +
                              " failed");
  observer.line("wrote", path);
  RETARGET_TRY(write_summary(folder, entries, observer));
  RETARGET_TRY(write_lists(folder, entries, rules, observer));
  return failed + missing.count;
}

}  // namespace retarget
