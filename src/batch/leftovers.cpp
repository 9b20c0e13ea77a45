#include "batch/leftovers.h"

#include <algorithm>
#include <system_error>

#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/options.h"
#include "retarget/run.h"

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
      if (!is_temporary_name(file.filename().string())) continue;
      const fs::file_status there = fs::symlink_status(file, error);
      if (fs::is_regular_file(there)) fs::remove(file, error);
      // Temporary folder of a motion that is a folder.
      if (fs::is_directory(there)) fs::remove_all(file, error);
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
      const bool is_contacts = file == task.robot->folder + contacts_output(task.input->relative) &&
                               !save.contacts.empty();
      const bool replaced =
          is_contacts || std::ranges::any_of(*items, [&](const OutputItem& item) {
            return file == item.path ||
                   (format_is_folder(item.format) && file.starts_with(item.path + "/")) ||
                   (task.robot->request.sidecar && file == item.path + ".json");
          });
      if (!replaced && is_file(fs::path(folder) / file)) files.push_back(file);
    }
  }
  return files;
}

}  // namespace retarget
