#include "base/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/try.h"
#include "retarget/file.h"
#include "retarget/os.h"

namespace retarget {
namespace {

namespace fs = std::filesystem;

Failure folder_failure(const std::string& path, int error_number) {
  return run_failure(path,
                     "cannot write the folder: " + std::generic_category().message(error_number));
}

// Number of the temporary name of an old folder while the new one replaces it.
constexpr int kAsideNumber = 1001;

// Flushes a folder to disk before it gets its final name.
Result<void> flush_folder(const std::string& path) {
  if (os::flush_folder(path) != 0) return folder_failure(path, errno);
  return {};
}

}  // namespace

Result<OutputFolder> OutputFolder::create(const std::string& given,
                                          const std::vector<std::string>& own) {
  OutputFolder folder;
  folder.path_ = os::without_last_separators(given);
  TRY(check_output_folder(folder.path_));
  std::error_code error;
  const fs::file_status there = fs::status(folder.path_, error);
  if (fs::exists(there) && !fs::is_directory(there)) {
    return usage_failure("the output \"" + folder.path_ + "\" is a file, expected a folder",
                         "give another name");
  }
  if (fs::is_directory(there)) {
    for (const fs::path& file : files_in_folder(folder.path_)) {
      const std::string name = file.filename().string();
      if (std::ranges::find(own, name) != own.end()) continue;
      return usage_failure("the folder \"" + folder.path_ + "\" holds \"" + name +
                               "\", which is not part of a motion and would be lost",
                           "give another name, or an empty folder");
    }
  }
  for (int number = 0;; ++number) {
    const std::string name = temporary_path(folder.path_, number);
    if (os::make_folder(name) == 0) {
      folder.temporary_ = name;
      return folder;
    }
    if (errno != EEXIST || number >= 1000) return folder_failure(folder.path_, errno);
  }
}

OutputFolder::~OutputFolder() {
  discard();
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept {
  *this = std::move(other);
}

OutputFolder& OutputFolder::operator=(OutputFolder&& other) noexcept {
  if (this == &other) return *this;
  discard();
  path_ = std::move(other.path_);
  temporary_ = std::exchange(other.temporary_, {});
  return *this;
}

void OutputFolder::discard() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
  temporary_.clear();
}

Result<void> OutputFolder::write(const std::string& name, std::string_view bytes) {
  if (temporary_.empty()) return folder_failure(path_, EBADF);
  auto written = write_file(temporary_ + "/" + name, bytes);
  if (written) return {};
  // Report the final name, because the user does not know the temporary one.
  written.error().location.file = path_ + "/" + name;
  discard();
  return written;
}

Result<void> OutputFolder::commit() {
  if (temporary_.empty()) return folder_failure(path_, EBADF);
  TRY(flush_folder(temporary_));
  if (os::move_over(temporary_, path_) == 0) {
    temporary_.clear();
    return {};
  }
  if (errno != ENOTEMPTY && errno != EEXIST) return folder_failure(path_, errno);
  // The folder exists: exchange both, then delete the old one under the temporary name.
  if (os::exchange(temporary_, path_) == 0) {
    discard();
    return {};
  }
  // Without an atomic exchange, there is a moment in which neither folder exists.
  const std::string aside = temporary_path(path_, kAsideNumber);
  if (os::move_over(path_, aside) != 0) return folder_failure(path_, errno);
  if (os::move_over(temporary_, path_) != 0) {
    const int error_number = errno;
    [[maybe_unused]] const int back = os::move_over(aside, path_);
    return folder_failure(path_, error_number);
  }
  temporary_ = aside;
  discard();
  return {};
}

}  // namespace retarget
