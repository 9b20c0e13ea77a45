#include "batch/output_tree.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>

#include "batch/certify_clip.h"
#include "retarget/certificate.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/options.h"
#include "retarget/run.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Files of a batch other than motions.
constexpr std::array kOwnFiles = {"manifest.jsonl", "summary.csv", "options.json",   "passed.txt",
                                  "failed.tsv",     "train.txt",   "validation.txt", "test.txt",
                                  "duplicates.tsv", "motions.yaml"};

// The files of a clip below a folder, including sidecars.
Result<std::vector<std::string>> outputs_of(const BatchInput& input, const BatchRequest& request,
                                            const std::string& folder) {
  const SaveOptions& save = request.run.options.save;
  RETARGET_TRY_ASSIGN(const auto items,
                      plan_outputs(folder + batch_output(save, input.relative), save));
  std::vector<std::string> files;
  for (const OutputItem& item : items) {
    files.push_back(item.path);
    if (request.of_clip.sidecar) files.push_back(item.path + ".json");
  }
  const OutputItem* const certified = request.certify ? certified_item(items) : nullptr;
  if (certified != nullptr) files.push_back(certificate_file(certified->path));
  if (request.contacts) files.push_back(folder + contacts_output(input.relative));
  return files;
}

// All files that a batch would write, to detect duplicates and conflicts of files with folders.
class OutputTree {
 public:
  explicit OutputTree(const BatchRequest& request) : request_(request) {
    if (!request.pack.empty()) files_[request.pack] = {};
    // With several robots, each has its own folder of clips.
    if (request.robots.size() > 1) return;
    for (const char* own : kOwnFiles) files_[own] = {};
  }

  Result<void> add(const BatchInput& input) {
    RETARGET_TRY_ASSIGN(const auto files, outputs_of(input, request_, {}));
    for (const std::string& file : files) RETARGET_TRY(add_file(file, input));
    return {};
  }

  // Call this after all files have been added.
  [[nodiscard]] Result<void> check_folders() const {
    for (const auto& [folder, input] : folders_) {
      const auto file = files_.find(folder);
      if (file == files_.end()) continue;
      return usage_failure("\"" + input->path + "\" would be written to a folder \"" + folder +
                               "\", which is " + what_is(file->second),
                           "rename one of them or exclude it with " RETARGET_OPTION("exclude"));
    }
    return {};
  }

 private:
  static std::string what_is(const BatchInput* owner) {
    return owner == nullptr ? "a file of the batch itself"
                            : "the output of \"" + owner->path + "\"";
  }

  Result<void> add_file(const std::string& path, const BatchInput& input) {
    const auto [owner, is_new] = files_.emplace(path, &input);
    if (!is_new) {
      return usage_failure("the output of \"" + input.path + "\" would be called \"" + path +
                               "\", which is " + what_is(owner->second),
                           "rename one of them, exclude it with " RETARGET_OPTION(
                               "exclude") ", or write one format at a time");
    }
    for (fs::path folder = fs::path(path).parent_path(); !folder.empty();
         folder = folder.parent_path()) {
      if (!folders_.emplace(folder.generic_string(), &input).second) break;
    }
    return {};
  }

  const BatchRequest& request_;
  std::map<std::string, const BatchInput*> files_;  // Clip; null: a file of the batch.
  std::map<std::string, const BatchInput*> folders_;
};

}  // namespace

Result<void> check_outputs_of(const std::vector<BatchInput>& inputs, const BatchRequest& request) {
  OutputTree tree(request);
  for (const BatchInput& input : inputs) {
    RETARGET_TRY(tree.add(input));
  }
  return tree.check_folders();
}

Result<void> check_outputs_spared(const std::vector<BatchInput>& inputs,
                                  const BatchRequest& request, const std::string& output,
                                  const std::list<BatchRobot>& robots) {
  std::vector<std::string> read = request.lists;
  read.insert(read.end(), request.gates.begin(), request.gates.end());
  read.push_back(request.clips);
  for (const BatchInput& input : inputs) read.push_back(input.path);
  for (const BatchRobot& robot : robots) {
    const std::vector<std::string> of_robot = files_of(robot.run, robot.setup.loaded.data_folder);
    read.insert(read.end(), of_robot.begin(), of_robot.end());
  }
  const WrittenFiles written(read);
  const std::string folder = output + "/";
  for (const char* own : kOwnFiles) {
    RETARGET_TRY(written.check_spared(folder + own));
  }
  for (const BatchRobot& robot : robots) {
    if (!request.pack.empty())
      RETARGET_TRY(written.check_spared(folder + robot.folder + request.pack));
    for (const BatchInput& input : inputs) {
      RETARGET_TRY_ASSIGN(const auto files, outputs_of(input, request, folder + robot.folder));
      for (const std::string& file : files) RETARGET_TRY(written.check_spared(file));
    }
  }
  return {};
}

namespace fs = std::filesystem;

std::set<fs::path> output_folders(const std::string& folder, const std::vector<BatchTask>& tasks) {
  std::set<fs::path> folders = {folder};
  for (const BatchTask& task : tasks) {
    folders.insert(
        fs::path(folder + "/" + task.robot->folder + task.input->relative).parent_path());
  }
  return folders;
}

std::set<fs::path> output_folders(const std::string& folder,
                                  const std::vector<ManifestEntry>& entries) {
  std::set<fs::path> folders = {folder};
  for (const ManifestEntry& entry : entries) {
    folders.insert(fs::path(folder + "/" + entry.relative).parent_path());
    folders.insert(fs::path(folder + "/" + entry.robot + "/" + entry.relative).parent_path());
  }
  return folders;
}

void remove_unfinished(const std::string& output_folder, const std::set<fs::path>& folders) {
  for (const fs::path& place : folders) {
    std::error_code error;
    if (place != output_folder &&
        !lies_in(output_folder, place.lexically_relative(output_folder).generic_string())) {
      continue;
    }
    for (const fs::path& file : files_in_folder(place)) {
      if (!is_temporary_name(file.filename().generic_string())) continue;
      const fs::file_status there = fs::symlink_status(file, error);
      if (fs::is_regular_file(there)) fs::remove(file, error);
      // Temporary folder of a motion that is a folder.
      if (fs::is_directory(there)) fs::remove_all(file, error);
    }
  }
}

std::vector<std::string> files_of_earlier_options(const std::string& folder,
                                                  const std::vector<BatchTask>& tasks,
                                                  const FinishedClips& finished, bool certify) {
  std::vector<std::string> files;
  for (const BatchTask& task : tasks) {
    const SaveOptions& save = task.robot->run.options.save;
    const auto items =
        plan_outputs(task.robot->folder + batch_output(save, task.input->relative), save);
    if (!items) continue;
    for (const std::string& file :
         finished.outputs_of(task.input->relative, task.robot->name, false)) {
      const bool is_contacts = file == task.robot->folder + contacts_output(task.input->relative) &&
                               !save.contacts.empty();
      const bool replaced =
          is_contacts || std::ranges::any_of(*items, [&](const OutputItem& item) {
            return file == item.path ||
                   (format_is_folder(item.format) && file.starts_with(item.path + "/")) ||
                   (task.robot->request.sidecar && file == item.path + ".json") ||
                   (certify && file == certificate_file(item.path));
          });
      if (!replaced && is_file(fs::path(folder) / file)) files.push_back(file);
    }
  }
  return files;
}

}  // namespace retarget
