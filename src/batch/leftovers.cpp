#include "batch/leftovers.h"

#include <algorithm>
#include <system_error>

#include "base/file.h"
#include "base/plain_name.h"
#include "plan/output_files.h"
#include "retarget/options.h"

namespace retarget {

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
        !lies_in(output_folder, place.lexically_relative(output_folder).string())) {
      continue;
    }
    for (const fs::path& file : files_in_folder(place)) {
      const bool is_own = is_temporary_name(file.filename().string()) &&
                          fs::is_regular_file(fs::symlink_status(file, error));
      if (is_own) fs::remove(file, error);
    }
  }
}

std::vector<std::string> files_of_earlier_options(const std::string& folder,
                                                  const std::vector<BatchTask>& tasks,
                                                  const FinishedClips& finished) {
  std::vector<std::string> files;
  for (const BatchTask& task : tasks) {
    const SaveOptions& save = task.robot->run.options.save;
    const auto items =
        plan_outputs(task.robot->folder + batch_output(save, task.input->relative), save);
    if (!items) continue;
    for (const std::string& file :
         finished.outputs_of(task.input->relative, task.robot->name, false)) {
      const bool replaced = std::ranges::any_of(*items, [&](const OutputItem& item) {
        return file == item.path || (task.robot->request.sidecar && file == item.path + ".json");
      });
      if (!replaced && is_file(fs::path(folder) / file)) files.push_back(file);
    }
  }
  return files;
}

}  // namespace retarget
