#include "batch/output_tree.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <functional>
#include <map>
#include <system_error>
#include <utility>

#include "batch/certify_clip.h"
#include "batch/manifests.h"
#include "retarget/certificate.h"
#include "retarget/file.h"
#include "retarget/motion_io.h"
#include "retarget/option_name.h"
#include "retarget/options.h"
#include "retarget/os.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

// Files of a batch other than motions.
constexpr std::array kOwnFiles = {"manifest.jsonl", "summary.csv", "options.json",   "passed.txt",
                                  "failed.tsv",     "train.txt",   "validation.txt", "test.txt",
                                  "duplicates.tsv", "motions.yaml"};

}  // namespace

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

namespace {

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
                               "\", which is " + owner_text(file->second),
                           "rename one of them or exclude it with " RETARGET_OPTION("exclude"));
    }
    return {};
  }

 private:
  static std::string owner_text(const BatchInput* owner) {
    return owner == nullptr ? "a file of the batch itself"
                            : "the output of \"" + owner->path + "\"";
  }

  Result<void> add_file(const std::string& path, const BatchInput& input) {
    const auto [owner, is_new] = files_.emplace(path, &input);
    if (!is_new) {
      return usage_failure("the output of \"" + input.path + "\" would be called \"" + path +
                               "\", which is " + owner_text(owner->second),
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

Result<void> check_outputs_new(const std::vector<BatchInput>& inputs, const BatchRequest& request,
                               const std::string& output, const std::list<BatchRobot>& robots,
                               bool whole) {
  std::vector<std::string> planned;
  for (const BatchRobot& robot : robots) {
    if (whole && !request.pack.empty()) planned.push_back(robot.folder + request.pack);
    for (const BatchInput& input : inputs) {
      RETARGET_TRY_ASSIGN(const auto files, outputs_of(input, request, robot.folder));
      planned.insert(planned.end(), files.begin(), files.end());
    }
  }
  std::error_code ignored;
  const auto existing = [&](std::vector<std::string> files) {
    std::erase_if(files, [&](const std::string& file) {
      return !fs::exists(fs::symlink_status(fs::path(output) / file, ignored));
    });
    return files;
  };
  std::vector<std::string> found = existing({kOwnFiles.begin(), kOwnFiles.end()});
  const auto is_link = [&](const std::string& file) {
    return fs::is_symlink(fs::path(output) / file, ignored);
  };
  // Another part that starts now writes its manifest before other files, so look for it last.
  if (!whole && has_manifest(output)) std::erase_if(found, std::not_fn(is_link));
  const std::vector<std::string> of_clips = existing(std::move(planned));
  found.insert(found.end(), of_clips.begin(), of_clips.end());
  constexpr std::size_t kShown = 3;
  std::vector<std::string> links = found;
  std::erase_if(links, std::not_fn(is_link));
  if (!links.empty()) {
    return usage_failure("the batch would write through " + count_text(links.size(), "link") +
                             " of the folder \"" + output + "\": " + list_names(links, kShown),
                         links.size() == 1 ? "remove the link first" : "remove the links first");
  }
  if (found.empty() || request.redo) return {};
  return usage_failure("the batch would replace " + count_text(found.size(), "file") +
                           " of the folder \"" + output +
                           "\" that no earlier batch records: " + list_names(found, kShown),
                       "give a new folder; " RETARGET_OPTION("redo") " replaces the files");
}

std::vector<std::string> files_of_discarded(const std::string& folder,
                                            const std::vector<ManifestEntry>& discarded,
                                            const std::vector<BatchTask>& tasks,
                                            const BatchRequest& request) {
  std::set<std::string> written;
  for (const BatchTask& task : tasks) {
    const auto files = outputs_of(*task.input, request, task.robot->folder);
    if (files) written.insert(files->begin(), files->end());
  }
  // A motion may be a folder of files.
  const auto is_written = [&](const std::string& file) {
    return written.contains(file) ||
           written.contains(fs::path(file).parent_path().generic_string());
  };
  std::set<std::string> left;
  for (const ManifestEntry& entry : discarded) {
    for (const FileRecord& output : entry.outputs) {
      if (!is_written(output.file) && is_file(fs::path(folder) / output.file)) {
        left.insert(output.file);
      }
    }
  }
  return {left.begin(), left.end()};
}

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

namespace {

std::string this_machine() {
  const std::string name = os::host_name();
  return name.empty() ? "this machine" : name;
}

// Text of the last holder in the lock file; may be empty.
std::string holder_of(int descriptor) {
  std::array<char, 512> text{};
  const std::int64_t count = os::read_bytes_at(descriptor, text.data(), text.size() - 1, 0);
  std::string holder(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  return holder.substr(0, holder.find('\n'));
}

// Whether a path still refers to the open file, which the last holder may have removed.
bool is_in_place(int descriptor, const std::string& path) {
  const auto open = os::status_of(descriptor), named = os::status_of(path);
  return open && named && open->id == named->id;
}

Failure lock_failure(const std::string& path, int error_number) {
  return run_failure(
      path, "cannot lock the output folder: " + std::generic_category().message(error_number),
      error_number == EACCES || error_number == EROFS
          ? "choose a folder with -o in which you may write"
          : "");
}

}  // namespace

Result<FolderLock> FolderLock::take(const std::string& folder, const std::string& name, Kind kind) {
  FolderLock lock;
  lock.path_ = folder + "/" + name;
  for (;;) {
    lock.descriptor_ = os::open_file(lock.path_, os::OpenFor::kLocking);
    if (lock.descriptor_ < 0) return lock_failure(lock.path_, errno);
    const auto how = kind == Kind::kAlone ? os::LockKind::kAlone : os::LockKind::kShared;
    if (os::lock_file(lock.descriptor_, how) != 0) {
      const int error_number = errno;
      if (error_number == EINTR) continue;
      if (error_number == ENOLCK || error_number == ENOSYS || error_number == EOPNOTSUPP) {
        return lock;
      }
      if (error_number != EWOULDBLOCK) return lock_failure(lock.path_, error_number);
      const std::string holder = holder_of(lock.descriptor_);
      return run_failure(folder,
                         "another batch is writing into this folder" +
                             (holder.empty() ? std::string() : ": " + holder),
                         "wait for it, stop it, or give another folder with -o");
    }
    if (is_in_place(lock.descriptor_, lock.path_)) break;
    os::close_file(std::exchange(lock.descriptor_, -1));
  }
  lock.held_ = true;
  const std::string text =
      "process " + std::to_string(os::process_id()) + " on " + this_machine() + "\n";
  if (os::resize_file(lock.descriptor_, 0) != 0 ||
      os::write_bytes_at(lock.descriptor_, text.data(), text.size(), 0) < 0) {
    // On a full disk the lock still works; only the message lacks the holder.
  }
  return lock;
}

void FolderLock::release() {
  if (descriptor_ < 0) return;
  // The last holder removes the file. Processes that have it open detect this with is_in_place().
  if (held_ && os::lock_file(descriptor_, os::LockKind::kAlone) == 0) os::remove_file(path_);
  os::close_file(std::exchange(descriptor_, -1));
  held_ = false;
}

FolderLock::~FolderLock() {
  release();
}

FolderLock::FolderLock(FolderLock&& other) noexcept {
  *this = std::move(other);
}

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  if (this == &other) return *this;
  release();
  path_ = std::move(other.path_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  held_ = std::exchange(other.held_, false);
  return *this;
}

}  // namespace retarget
