// System calls of Linux and macOS.

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __APPLE__
#include <mach-o/dyld.h>
#endif

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "retarget/os.h"

namespace retarget::os {
namespace {

namespace fs = std::filesystem;

FileStatus status_in(const struct stat& info) {
#ifdef __APPLE__
  const auto& modified = info.st_mtimespec;
#else
  const auto& modified = info.st_mtim;
#endif
  FileStatus status;
  status.kind = S_ISREG(info.st_mode)   ? EntryKind::kRegular
                : S_ISDIR(info.st_mode) ? EntryKind::kFolder
                : S_ISCHR(info.st_mode) ? EntryKind::kDevice
                                        : EntryKind::kOther;
  status.id = {static_cast<std::uint64_t>(info.st_dev), static_cast<std::uint64_t>(info.st_ino)};
  status.bytes = static_cast<std::uint64_t>(info.st_size);
  status.modified_ns =
      std::int64_t{modified.tv_sec} * 1'000'000'000 + std::int64_t{modified.tv_nsec};
  status.permissions = info.st_mode & 07777;
  return status;
}

constexpr mode_t kForAll = 0666, kForOwner = 0644;

}  // namespace

std::optional<FileStatus> status_of(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return std::nullopt;
  return status_in(info);
}

std::optional<FileStatus> status_of(int descriptor) {
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) return std::nullopt;
  return status_in(info);
}

int open_file(const std::string& path, OpenFor purpose) {
  const char* const name = path.c_str();
  switch (purpose) {
    case OpenFor::kReading:
      return ::open(name, O_RDONLY | O_CLOEXEC);
    case OpenFor::kReadingAtOnce:
      return ::open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    case OpenFor::kWriting:
      return ::open(name, O_WRONLY | O_CLOEXEC);
    case OpenFor::kAppending:
      return ::open(name, O_WRONLY | O_APPEND | O_CLOEXEC);
    case OpenFor::kCreating:
      return ::open(name, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, kForAll);
    case OpenFor::kReplacing:
      return ::open(name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NONBLOCK, kForOwner);
    case OpenFor::kLocking:
      return ::open(name, O_CREAT | O_RDWR | O_CLOEXEC, kForAll);
  }
  errno = EINVAL;
  return -1;
}

void close_file(int descriptor) {
  ::close(descriptor);
}

std::int64_t read_bytes(int descriptor, void* bytes, std::size_t count) {
  return ::read(descriptor, bytes, count);
}

std::int64_t write_bytes(int descriptor, const void* bytes, std::size_t count) {
  return ::write(descriptor, bytes, count);
}

std::int64_t read_bytes_at(int descriptor, void* bytes, std::size_t count, std::int64_t at) {
  return ::pread(descriptor, bytes, count, static_cast<off_t>(at));
}

std::int64_t write_bytes_at(int descriptor, const void* bytes, std::size_t count, std::int64_t at) {
  return ::pwrite(descriptor, bytes, count, static_cast<off_t>(at));
}

std::int64_t seek_end(int descriptor) {
  return ::lseek(descriptor, 0, SEEK_END);
}

int resize_file(int descriptor, std::int64_t bytes) {
  return ::ftruncate(descriptor, static_cast<off_t>(bytes));
}

int flush_to_disk(int descriptor, bool data_only) {
#ifndef __APPLE__
  if (data_only) return ::fdatasync(descriptor);
#endif
  static_cast<void>(data_only);
  return ::fsync(descriptor);
}

int flush_folder(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return -1;
  const int flushed = ::fsync(descriptor);
  const int error_number = errno;
  ::close(descriptor);
  errno = error_number;
  // Some file systems do not support fsync on folders; ignore them.
  return flushed != 0 && error_number != EINVAL ? -1 : 0;
}

int create_unnamed([[maybe_unused]] const std::string& folder) {
#ifdef O_TMPFILE
  return ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kForAll);
#else
  errno = ENOSYS;
  return -1;
#endif
}

int name_file(int descriptor, const std::string& path) {
  const std::string handle = "/proc/self/fd/" + std::to_string(descriptor);
  return ::linkat(AT_FDCWD, handle.c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW);
}

int set_permissions(int descriptor, unsigned permissions) {
  return ::fchmod(descriptor, static_cast<mode_t>(permissions));
}

bool may_write(const std::string& path) {
  return ::access(path.c_str(), W_OK) == 0;
}

int make_folder(const std::string& path) {
  return ::mkdir(path.c_str(), 0777);
}

int move_over(const std::string& from, const std::string& to) {
  return ::rename(from.c_str(), to.c_str());
}

int move_to_new(const std::string& from, const std::string& to) {
#ifdef RENAME_NOREPLACE
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return -1;
#elif defined(RENAME_EXCL)
  if (::renamex_np(from.c_str(), to.c_str(), RENAME_EXCL) == 0) return 0;
  if (errno != ENOTSUP) return -1;
#endif
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(to, ignored))) {
    errno = EEXIST;
    return -1;
  }
  return ::rename(from.c_str(), to.c_str());
}

int exchange([[maybe_unused]] const std::string& a, [[maybe_unused]] const std::string& b) {
#ifdef RENAME_EXCHANGE
  return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE);
#elif defined(RENAME_SWAP)
  if (::renamex_np(a.c_str(), b.c_str(), RENAME_SWAP) == 0) return 0;
  if (errno == ENOTSUP) errno = ENOSYS;
  return -1;
#else
  errno = ENOSYS;
  return -1;
#endif
}

int remove_file(const std::string& path) {
  return ::unlink(path.c_str());
}

int remove_folder(const std::string& path) {
  return ::rmdir(path.c_str());
}

int lock_file([[maybe_unused]] int descriptor, [[maybe_unused]] LockKind kind) {
#ifdef __wasi__
  errno = ENOSYS;
  return -1;
#else
  return ::flock(descriptor, (kind == LockKind::kAlone ? LOCK_EX : LOCK_SH) | LOCK_NB);
#endif
}

bool is_out_of_space(int error_number) {
  return error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
}

int process_id() {
  return ::getpid();
}

namespace {

// Signal handlers can only access globals.
volatile std::sig_atomic_t* stop_flag = nullptr;

void take_termination(int signal_number, siginfo_t* info, void* /*context*/) {
  if (info->si_pid == ::getppid()) {
    *stop_flag = 1;
    return;
  }
  std::signal(signal_number, SIG_DFL);
  ::kill(::getpid(), signal_number);
}

}  // namespace

void leave_interrupts_to_parent(volatile std::sig_atomic_t& stopped) {
  std::signal(SIGINT, SIG_IGN);
  stop_flag = &stopped;
  struct sigaction action {};
  action.sa_sigaction = take_termination;
  action.sa_flags = SA_SIGINFO;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGTERM, &action, nullptr);
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : std::string();
}

fs::path program_file() {
  std::error_code unknown;
#ifdef __APPLE__
  std::uint32_t size = 0;
  _NSGetExecutablePath(nullptr, &size);
  std::string name(size, '\0');
  if (_NSGetExecutablePath(name.data(), &size) != 0) return {};
  const fs::path file = fs::weakly_canonical(name.c_str(), unknown);
#else
  const fs::path file = fs::read_symlink("/proc/self/exe", unknown);
#endif
  return unknown ? fs::path() : file;
}

std::uint64_t physical_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return 0;
  return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page);
}

std::optional<fs::path> folder_of_user_data() {
  const auto folder_in = [](const char* variable) -> std::optional<fs::path> {
    const char* value = std::getenv(variable);
    if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
    return fs::path(value);
  };
  if (const auto data = folder_in("XDG_DATA_HOME")) return data;
  if (const auto home = folder_in("HOME")) return *home / ".local" / "share";
  return std::nullopt;
}

std::string with_slashes(std::string path) {
  return path;
}

}  // namespace retarget::os
