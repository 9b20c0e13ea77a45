#include "batch/folder_lock.h"
#include "retarget/os.h"

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace retarget {
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
      path, "cannot lock the output folder: " + std::generic_category().message(error_number));
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
  // The last holder removes the file. Processes that have it open notice this with is_in_place().
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
