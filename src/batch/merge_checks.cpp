#include "batch/merge_checks.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string_view>
#include <utility>

#include "batch/manifests.h"
#include "retarget/option_name.h"
#include "retarget/option_table.h"
#include "retarget/text.h"

namespace retarget {
namespace {

// Options that apply to a merge.
constexpr std::array<std::string_view, 6> kOfMerges = {"output", "gate",        "dedupe",
                                                       "split",  "motion-list", "pack"};

OptionTable rows_of_merge(BatchRequest& request) {
  OptionTable table = batch_table(request, request.run);
  append(table, without_rows_of(table, run_table(request.run)));
  return table;
}

Failure refused_by_merge(const std::string& option, const char* why) {
  return usage_failure(option + " and " RETARGET_OPTION("merge") " cannot be combined", why);
}

// The index and the number of shards in the name of a manifest.
std::optional<Shard> shard_of(const std::string& file) {
  static const std::regex kName(R"(manifest\.([1-9][0-9]*)-of-([1-9][0-9]*)\.jsonl)");
  const std::string name = std::filesystem::path(file).filename().generic_string();
  std::smatch match;
  if (!std::regex_match(name, match, kName)) return std::nullopt;
  const auto index = parse_number<int>(match[1].str());
  const auto count = parse_number<int>(match[2].str());
  if (!index || !count || *index > *count) return std::nullopt;
  return Shard{*index, *count};
}

std::set<std::pair<std::string_view, std::string_view>> clips_among(
    const std::vector<ManifestEntry>& entries) {
  std::set<std::pair<std::string_view, std::string_view>> clips;
  for (const ManifestEntry& entry : entries) clips.emplace(entry.relative, entry.robot);
  return clips;
}

}  // namespace

Result<void> check_merge(const BatchRequest& request) {
  constexpr const char* kOnlyJoins = RETARGET_OPTION("merge") " only joins manifests";
  BatchRequest given = request, plain;
  for (const std::string& name : changed_options(rows_of_merge(given), rows_of_merge(plain))) {
    if (std::ranges::find(kOfMerges, name) != kOfMerges.end()) continue;
    // It selects the files of a pack.
    if (name == "format" && !request.pack.empty()) continue;
    return refused_by_merge(marked_option(name),
                            name == "format" ? "it requires " RETARGET_OPTION("pack") : kOnlyJoins);
  }
  if (request.of_clip.sidecar) return refused_by_merge(RETARGET_OPTION("sidecar"), kOnlyJoins);
  if (request.of_clip.dynamics) return refused_by_merge(RETARGET_OPTION("dynamics"), kOnlyJoins);
  if (!request.quality) return refused_by_merge(RETARGET_OPTION("no-quality"), kOnlyJoins);
  return {};
}

MissingShards missing_shards(const std::vector<std::string>& manifests,
                             const std::vector<ManifestEntry>& merged,
                             const std::vector<ManifestEntry>& others) {
  constexpr std::size_t kNamed = 5;
  MissingShards missing;
  if (!std::ranges::includes(clips_among(others), clips_among(merged))) return missing;
  std::map<int, std::set<int>> found;  // Indices by number of shards.
  for (const std::string& file : manifests) {
    if (const auto shard = shard_of(file)) found[shard->count].insert(shard->index);
  }
  for (const auto& [count, indices] : found) {
    const std::size_t lacking = static_cast<std::size_t>(count) - indices.size();
    const std::size_t named = std::min(missing.names.size() + lacking, kNamed);
    missing.count += lacking;
    for (int index = 1; missing.names.size() < named; ++index) {
      if (indices.contains(index)) continue;
      missing.names.push_back(shard_file_name("manifest", {index, count}, ".jsonl"));
    }
  }
  return missing;
}

void warn_of_missing_shards(const MissingShards& missing, const std::string& folder,
                            Observer& observer) {
  if (missing.count == 0) return;
  std::string names = list_names(missing.names);
  if (missing.count > missing.names.size()) names += ", ...";
  observer.warn({{0, 0,
                  count_text(missing.count, "shard") +
                      (missing.count == 1 ? " has no manifest: " : " have no manifests: ") + names +
                      "; process " + (missing.count == 1 ? "it" : "them") +
                      " with " RETARGET_OPTION("shard") " and " RETARGET_OPTION(
                          "resume") ", then merge again"}},
                folder);
}

void warn_of_mixed_options(const std::vector<ManifestEntry>& entries, const std::string& path,
                           Observer& observer) {
  // The first clip with each set of options, by robot.
  std::map<std::string_view, std::map<std::string_view, const ManifestEntry*>> robots;
  for (const ManifestEntry& entry : entries) {
    if (entry.done) robots[entry.robot].emplace(entry.options_hash, &entry);
  }
  for (const auto& [robot, sets] : robots) {
    if (sets.size() < 2) continue;
    const ManifestEntry& one = *sets.begin()->second;
    const ManifestEntry& other = *std::next(sets.begin())->second;
    std::string text = "the clips of " + std::string(robot) + " were made with " +
                       std::to_string(sets.size()) + " different sets of options, such as \"" +
                       one.relative + "\" and \"" + other.relative + "\"";
    if (one.fps != other.fps) {
      text += " at " + number_text(one.fps, 3) + " and " + number_text(other.fps, 3) +
              " frames per second";
    }
    text += "; the batch with " RETARGET_OPTION("resume") " makes them alike";
    observer.warn({{0, 0, std::move(text)}}, path);
  }
}

}  // namespace retarget
