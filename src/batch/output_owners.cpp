#include "batch/output_owners.h"

#include <map>
#include <string_view>
#include <utility>

#include "batch/manifests.h"
#include "batch/output_tree.h"
#include "retarget/option_name.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

// The entry that wrote a file last, by output file.
using OutputOwners = std::map<std::string_view, const ManifestEntry*>;

OutputOwners owners_among(const std::vector<ManifestEntry>& entries) {
  OutputOwners owners;
  for (const ManifestEntry& entry : entries) {
    for (const FileRecord& output : entry.outputs) {
      const ManifestEntry*& owner = owners[output.file];
      if (owner == nullptr || owner->finished < entry.finished) owner = &entry;
    }
  }
  return owners;
}

// The owners of a file, or of the files in a folder that is a motion.
std::vector<const ManifestEntry*> owners_of(const std::string& output, const OutputOwners& owners) {
  std::vector<const ManifestEntry*> found;
  if (const auto at = owners.find(output); at != owners.end()) found.push_back(at->second);
  const std::string folder = output + "/";
  for (auto at = owners.lower_bound(folder); at != owners.end() && at->first.starts_with(folder);
       ++at) {
    found.push_back(at->second);
  }
  return found;
}

bool belongs_to(const ManifestEntry& entry, const BatchInput& input, const BatchRobot& robot) {
  return entry.relative == input.relative && entry.robot == robot.name;
}

Failure owned_failure(const std::string& output, const BatchInput& input, const BatchRobot& robot,
                      const ManifestEntry& owner) {
  const bool same_clip = owner.relative == input.relative;
  return usage_failure(
      "the output \"" + output + "\" of \"" + input.relative + "\" for " + robot.name +
          " would replace that of \"" + owner.relative + "\" for " + owner.robot +
          ", which an earlier run made",
      std::string("give another folder; ") +
          (same_clip ? RETARGET_OPTION("redo") " starts over"
                     : RETARGET_OPTION("exclude") " leaves one of them out, " RETARGET_OPTION(
                           "redo") " starts over"));
}

// Whether the relative path of a clip may refer to the working directory of an earlier run.
bool may_be_elsewhere(const ManifestEntry& entry) {
  const auto folder = std::filesystem::path(entry.input.file).parent_path();
  std::error_code ignored;
  return folder.is_relative() && !folder.empty() && !std::filesystem::is_directory(folder, ignored);
}

}  // namespace

Result<std::vector<ManifestEntry>> entries_that_give_way(const std::vector<BatchInput>& inputs,
                                                         const BatchRequest& request,
                                                         const std::list<BatchRobot>& robots,
                                                         const std::vector<ManifestEntry>& known,
                                                         const std::set<std::string>& clips) {
  const std::vector<ManifestEntry> entries = latest_entries(known);
  const OutputOwners owners = owners_among(entries);
  std::set<const ManifestEntry*> gone;
  for (const BatchRobot& robot : robots) {
    for (const BatchInput& input : inputs) {
      RETARGET_TRY_ASSIGN(const auto files, outputs_of(input, request, robot.folder));
      for (const std::string& file : files) {
        for (const ManifestEntry* owner : owners_of(file, owners)) {
          if (belongs_to(*owner, input, robot)) continue;
          if (may_be_elsewhere(*owner) || !clip_is_gone(*owner, clips)) {
            return owned_failure(file, input, robot, *owner);
          }
          gone.insert(owner);
        }
      }
    }
  }
  std::vector<ManifestEntry> found;
  for (const ManifestEntry& entry : entries) {
    if (gone.contains(&entry)) found.push_back(entry);
  }
  return found;
}

void remove_replaced_entries(std::vector<ManifestEntry>& entries, const std::string& path,
                             Observer& observer) {
  const OutputOwners owners = owners_among(entries);
  std::string example;
  std::set<std::pair<std::string, std::string>> replaced;
  for (const ManifestEntry& entry : entries) {
    for (const FileRecord& output : entry.outputs) {
      const ManifestEntry* owner = owners.at(output.file);
      if (owner == &entry) continue;
      if (replaced.empty()) {
        example = "\"" + output.file + "\" of \"" + entry.relative + "\" for " + entry.robot +
                  ", now that of \"" + owner->relative + "\" for " + owner->robot;
      }
      replaced.emplace(entry.relative, entry.robot);
    }
  }
  if (replaced.empty()) return;
  // `owners` refers to the entries and is no longer used.
  std::erase_if(entries, [&](const ManifestEntry& entry) {
    return replaced.contains({entry.relative, entry.robot});
  });
  observer.warn({{0, 0,
                  count_text(replaced.size(), "clip") +
                      " dropped, because another clip has replaced the output: " + example}},
                path);
}

}  // namespace retarget
