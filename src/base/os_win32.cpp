// System calls of Windows, with the meanings that the library expects of POSIX.

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX 1
#include <windows.h>

#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cwchar>

#include "retarget/os.h"

// libstdc++ before version 13 converts narrow paths by the C library's locale, which has no UTF-8 here. The linker
// gives it this function for mbrtowc. Its caller takes one wide character per call, so a pair of surrogates takes two:
// the first call reads three of the four bytes and keeps what the second one needs. Other bytes become U+FFFD, because a
// path from a file must not throw.
extern "C" std::size_t __wrap_mbrtowc(wchar_t* to, const char* from, std::size_t size,
                                      std::mbstate_t* state) {
  constexpr std::uint32_t kReplacement = 0xfffdU;
  if (from == nullptr) return 0;
  if (size == 0) return static_cast<std::size_t>(-2);
  const auto byte = [&](std::size_t i) {
    return std::uint32_t{static_cast<unsigned char>(from[i])};
  };
  const auto give = [&](std::uint32_t unit, std::size_t used) {
    if (to != nullptr) *to = static_cast<wchar_t>(unit);
    return unit == 0 ? 0 : used;
  };
  if (state != nullptr && *state != 0) {
    const auto kept = static_cast<std::uint32_t>(*state);
    *state = 0;
    return give(kept | (byte(0) & 0x3fU), 1);
  }
  if (byte(0) < 0x80U) return give(byte(0), 1);
  const std::size_t length = byte(0) >= 0xf0U ? 4 : byte(0) >= 0xe0U ? 3 : 2;
  if (byte(0) < 0xc2U || byte(0) > 0xf4U || size < length) return give(kReplacement, 1);
  std::uint32_t code = byte(0) & (0x7fU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80U) return give(kReplacement, 1);
    code = (code << 6U) | (byte(i) & 0x3fU);
  }
  const bool is_surrogate = code >= 0xd800U && code < 0xe000U;
  const bool is_overlong = (length == 3 && code < 0x800U) || (length == 4 && code < 0x10000U);
  if (is_surrogate || is_overlong || code > 0x10ffffU) return give(kReplacement, 1);
  if (length < 4) return give(code, length);
  if (state == nullptr) return give(kReplacement, length);
  code -= 0x10000U;
  *state = static_cast<std::mbstate_t>(0xdc00U | (code & 0x3c0U));
  return give(0xd800U | (code >> 10U), 3);
}

namespace retarget::os {
namespace {

namespace fs = std::filesystem;

// std::filesystem::path would convert by the locale in some versions of libstdc++.
std::wstring wide(const std::string& text) {
  const int size = static_cast<int>(std::min<std::size_t>(text.size(), INT_MAX));
  const int length = ::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, nullptr, 0);
  std::wstring result(static_cast<std::size_t>(std::max(0, length)), L'\0');
  ::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, result.data(), length);
  std::ranges::replace(result, L'/', L'\\');
  return result;
}

int errno_of(DWORD error) {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_NETPATH:
    case ERROR_BAD_PATHNAME:
    case ERROR_INVALID_DRIVE:
    case ERROR_NOT_READY:
      return ENOENT;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
    case ERROR_WRITE_PROTECT:
      return EACCES;
    case ERROR_LOCK_VIOLATION:
    case ERROR_IO_PENDING:
      return EWOULDBLOCK;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      return EEXIST;
    case ERROR_DIR_NOT_EMPTY:
      return ENOTEMPTY;
    case ERROR_DIRECTORY:
      return ENOTDIR;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      return ENOSPC;
    case ERROR_FILE_TOO_LARGE:
      return EFBIG;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY:
      return ENOMEM;
    case ERROR_TOO_MANY_OPEN_FILES:
      return EMFILE;
    case ERROR_NOT_SAME_DEVICE:
      return EXDEV;
    case ERROR_FILENAME_EXCED_RANGE:
      return ENAMETOOLONG;
    case ERROR_INVALID_HANDLE:
      return EBADF;
    case ERROR_BROKEN_PIPE:
    case ERROR_NO_DATA:
      return EPIPE;
    case ERROR_NOT_SUPPORTED:
    case ERROR_INVALID_FUNCTION:
      return ENOSYS;
    default:
      return EIO;
  }
}

int failed() {
  errno = errno_of(::GetLastError());
  return -1;
}

int result_of(BOOL done) {
  return done ? 0 : failed();
}

std::uint64_t joined(DWORD high, DWORD low) {
  return (std::uint64_t{high} << 32U) | low;
}

HANDLE handle_of(int descriptor) {
  return reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor));
}

std::optional<FileStatus> status_of_handle(HANDLE handle) {
  FileStatus status;
  switch (::GetFileType(handle)) {
    case FILE_TYPE_DISK:
      break;
    case FILE_TYPE_CHAR:
      status.kind = EntryKind::kDevice;
      return status;
    case FILE_TYPE_PIPE:
      return status;
    default:
      errno = EBADF;
      return std::nullopt;
  }
  BY_HANDLE_FILE_INFORMATION info{};
  if (!::GetFileInformationByHandle(handle, &info)) {
    failed();
    return std::nullopt;
  }
  const bool folder = (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
  status.kind = folder ? EntryKind::kFolder : EntryKind::kRegular;
  status.id = {info.dwVolumeSerialNumber, joined(info.nFileIndexHigh, info.nFileIndexLow)};
  status.bytes = folder ? 0 : joined(info.nFileSizeHigh, info.nFileSizeLow);
  // Windows counts in 100 ns since 1601.
  constexpr std::int64_t kFrom1601To1970 = 116'444'736'000'000'000;
  const auto modified = static_cast<std::int64_t>(
      joined(info.ftLastWriteTime.dwHighDateTime, info.ftLastWriteTime.dwLowDateTime));
  status.modified_ns = (modified - kFrom1601To1970) * 100;
  return status;
}

// As POSIX does, allows others to rename and remove the file while it is open.
constexpr DWORD kSharing = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

class OpenHandle {
 public:
  explicit OpenHandle(HANDLE handle) : handle_(handle) {}
  ~OpenHandle() {
    if (is_open()) ::CloseHandle(handle_);
  }
  OpenHandle(const OpenHandle&) = delete;
  OpenHandle& operator=(const OpenHandle&) = delete;
  [[nodiscard]] HANDLE get() const { return handle_; }
  [[nodiscard]] bool is_open() const { return handle_ != INVALID_HANDLE_VALUE; }

 private:
  HANDLE handle_;
};

HANDLE open_for_status(const std::wstring& name) {
  return ::CreateFileW(name.c_str(), FILE_READ_ATTRIBUTES, kSharing, nullptr, OPEN_EXISTING,
                       FILE_FLAG_BACKUP_SEMANTICS, nullptr);
}

bool is_folder(const std::wstring& name) {
  const DWORD attributes = ::GetFileAttributesW(name.c_str());
  return attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
}

unsigned piece_of(std::size_t count) {
  return static_cast<unsigned>(std::min<std::size_t>(count, std::size_t{1} << 30U));
}

OVERLAPPED place_at(std::int64_t at) {
  OVERLAPPED place{};
  place.Offset = static_cast<DWORD>(static_cast<std::uint64_t>(at) & 0xffffffffU);
  place.OffsetHigh = static_cast<DWORD>(static_cast<std::uint64_t>(at) >> 32U);
  return place;
}

// The value of an environment variable as a path.
std::optional<fs::path> folder_in(const wchar_t* variable) {
  const wchar_t* value = ::_wgetenv(variable);
  if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
  return fs::path(value);
}

}  // namespace

std::optional<FileStatus> status_of(const std::string& path) {
  const OpenHandle handle(open_for_status(wide(path)));
  if (handle.is_open()) return status_of_handle(handle.get());
  failed();
  return std::nullopt;
}

std::optional<FileStatus> status_of(int descriptor) {
  return status_of_handle(handle_of(descriptor));
}

int open_file(const std::string& path, OpenFor purpose) {
  const std::wstring name = wide(path);
  DWORD access = GENERIC_WRITE, creation = OPEN_EXISTING;
  int flags = _O_BINARY | _O_NOINHERIT;
  switch (purpose) {
    case OpenFor::kReading:
    case OpenFor::kReadingAtOnce:
      access = GENERIC_READ;
      flags |= _O_RDONLY;
      break;
    case OpenFor::kWriting:
      flags |= _O_WRONLY;
      break;
    case OpenFor::kAppending:
      access = FILE_APPEND_DATA | FILE_WRITE_DATA | SYNCHRONIZE | FILE_READ_ATTRIBUTES;
      flags |= _O_WRONLY | _O_APPEND;
      break;
    case OpenFor::kCreating:
      access |= DELETE;  // Renamed while it is open.
      creation = CREATE_NEW;
      flags |= _O_WRONLY;
      break;
    case OpenFor::kReplacing:
      creation = CREATE_ALWAYS;
      flags |= _O_WRONLY;
      break;
    case OpenFor::kLocking:
      access = GENERIC_READ | GENERIC_WRITE;
      creation = OPEN_ALWAYS;
      flags |= _O_RDWR;
      break;
  }
  if (is_folder(name)) {
    // As POSIX: a new file needs an unused name.
    errno = purpose == OpenFor::kCreating ? EEXIST : EISDIR;
    return -1;
  }
  const HANDLE handle = ::CreateFileW(name.c_str(), access, kSharing, nullptr, creation,
                                      FILE_ATTRIBUTE_NORMAL, nullptr);
  if (handle == INVALID_HANDLE_VALUE) return failed();
  const int descriptor = ::_open_osfhandle(reinterpret_cast<std::intptr_t>(handle), flags);
  if (descriptor < 0) ::CloseHandle(handle);
  return descriptor;
}

void close_file(int descriptor) {
  ::_close(descriptor);
}

std::int64_t read_bytes(int descriptor, void* bytes, std::size_t count) {
  const int done = ::_read(descriptor, bytes, piece_of(count));
  // The writer of a pipe has ended.
  return done < 0 && errno == EPIPE ? 0 : done;
}

std::int64_t write_bytes(int descriptor, const void* bytes, std::size_t count) {
  const int done = ::_write(descriptor, bytes, piece_of(count));
  // The C library reports a pipe without a reader as EINVAL.
  if (done < 0 && errno == EINVAL) errno = EPIPE;
  return done;
}

std::int64_t read_bytes_at(int descriptor, void* bytes, std::size_t count, std::int64_t at) {
  OVERLAPPED place = place_at(at);
  DWORD done = 0;
  if (::ReadFile(handle_of(descriptor), bytes, piece_of(count), &done, &place)) return done;
  return ::GetLastError() == ERROR_HANDLE_EOF ? 0 : failed();
}

std::int64_t write_bytes_at(int descriptor, const void* bytes, std::size_t count, std::int64_t at) {
  OVERLAPPED place = place_at(at);
  DWORD done = 0;
  if (::WriteFile(handle_of(descriptor), bytes, piece_of(count), &done, &place)) return done;
  return failed();
}

std::int64_t seek_end(int descriptor) {
  return ::_lseeki64(descriptor, 0, SEEK_END);
}

int resize_file(int descriptor, std::int64_t bytes) {
  FILE_END_OF_FILE_INFO end{};
  end.EndOfFile.QuadPart = bytes;
  return result_of(
      ::SetFileInformationByHandle(handle_of(descriptor), FileEndOfFileInfo, &end, sizeof end));
}

int flush_to_disk(int descriptor, bool /*data_only*/) {
  return result_of(::FlushFileBuffers(handle_of(descriptor)));
}

int flush_folder(const std::string& /*path*/) {
  return 0;
}

int create_unnamed(const std::string& /*folder*/) {
  errno = ENOSYS;
  return -1;
}

int name_file(int /*descriptor*/, const std::string& /*path*/) {
  errno = ENOSYS;
  return -1;
}

int set_permissions(int /*descriptor*/, unsigned /*permissions*/) {
  return 0;
}

bool may_write(const std::string& path) {
  const DWORD attributes = ::GetFileAttributesW(wide(path).c_str());
  if (attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_READONLY) == 0) {
    return true;
  }
  errno = attributes == INVALID_FILE_ATTRIBUTES ? errno_of(::GetLastError()) : EACCES;
  return false;
}

int make_folder(const std::string& path) {
  return result_of(::CreateDirectoryW(wide(path).c_str(), nullptr));
}

int move_over(const std::string& from, const std::string& to) {
  const std::wstring source = wide(from), target = wide(to);
  if (is_folder(target)) {
    // rename() of POSIX replaces an empty folder by a folder.
    if (!is_folder(source)) {
      errno = EISDIR;
      return -1;
    }
    if (!::RemoveDirectoryW(target.c_str())) return failed();
  }
  return result_of(::MoveFileExW(source.c_str(), target.c_str(),
                                 MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH));
}

int move_to_new(const std::string& from, const std::string& to) {
  return result_of(::MoveFileExW(wide(from).c_str(), wide(to).c_str(), MOVEFILE_WRITE_THROUGH));
}

int exchange(const std::string& /*a*/, const std::string& /*b*/) {
  errno = ENOSYS;
  return -1;
}

int remove_file(const std::string& path) {
  return result_of(::DeleteFileW(wide(path).c_str()));
}

int remove_folder(const std::string& path) {
  return result_of(::RemoveDirectoryW(wide(path).c_str()));
}

int lock_file(int descriptor, LockKind kind) {
  // A lock prevents other processes from reading the locked bytes, so the locked byte lies far
  // behind the content.
  OVERLAPPED place = place_at(std::int64_t{1} << 62U);
  const HANDLE handle = handle_of(descriptor);
  // Release this process's previous lock, which the new one replaces.
  ::UnlockFileEx(handle, 0, 1, 0, &place);
  const DWORD alone = kind == LockKind::kAlone ? LOCKFILE_EXCLUSIVE_LOCK : 0;
  return result_of(::LockFileEx(handle, alone | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &place));
}

bool is_out_of_space(int error_number) {
  return error_number == ENOSPC || error_number == EFBIG;
}

int process_id() {
  return static_cast<int>(::GetCurrentProcessId());
}

void leave_interrupts_to_parent(volatile std::sig_atomic_t& /*stopped*/) {}

std::string host_name() {
  std::array<wchar_t, MAX_COMPUTERNAME_LENGTH + 1> name{};
  DWORD size = name.size();
  return ::GetComputerNameW(name.data(), &size) ? fs::path(name.data()).string() : std::string();
}

fs::path program_file() {
  std::wstring name(1U << 15U, L'\0');
  const DWORD length = ::GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  name.resize(length);
  return name;
}

std::uint64_t physical_memory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  return ::GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : 0;
}

std::optional<fs::path> folder_of_user_data() {
  if (const auto data = folder_in(L"XDG_DATA_HOME")) return data;
  return folder_in(L"LOCALAPPDATA");
}

std::string with_slashes(std::string path) {
  std::ranges::replace(path, '\\', '/');
  return path;
}

}  // namespace retarget::os
