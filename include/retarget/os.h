#pragma once

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// System calls whose names or meanings differ between POSIX systems and Windows. Paths are UTF-8.
/// Like those of POSIX, they return -1 (or nothing) and set errno when they fail.
namespace os {

/// Separators of the parts of a path.
#ifdef _WIN32
inline constexpr std::string_view kSeparators = "/\\";
#else
inline constexpr std::string_view kSeparators = "/";
#endif
/// A path without separators at its end: it names the same folder.
[[nodiscard]] std::string without_last_separators(std::string path);

/// Characters besides separators that names of files cannot have, or that lead elsewhere.
#ifdef _WIN32
inline constexpr std::string_view kNotInNames = ":*?\"<>|";
#else
inline constexpr std::string_view kNotInNames = "";
#endif

/// Descriptors of the standard streams.
inline constexpr int kStandardInput = 0, kStandardOutput = 1, kStandardError = 2;

enum class EntryKind : unsigned char {
  kRegular,
  kFolder,
  kDevice,  ///< A character device: a terminal, /dev/null.
  kOther,   ///< A pipe, a socket, a block device.
};

/// Equal for two names of one file.
using FileId = std::pair<std::uint64_t, std::uint64_t>;

struct FileStatus {
  EntryKind kind = EntryKind::kOther;
  FileId id;
  std::uint64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< Since 1970.
  unsigned permissions = 0;      ///< POSIX: the mode without the type. Windows: 0.
};

/// The file that a path names, links followed.
[[nodiscard]] std::optional<FileStatus> status_of(const std::string& path);
/// The file that a descriptor has open.
[[nodiscard]] std::optional<FileStatus> status_of(int descriptor);

enum class OpenFor : unsigned char {
  kReading,
  kReadingAtOnce,  ///< Does not wait for the writer of a pipe.
  kWriting,        ///< An existing file, pipe or device.
  kAppending,      ///< An existing file.
  kCreating,       ///< A new file; EEXIST if there is one.
  kReplacing,      ///< Empties an existing file. A pipe without a reader: ENXIO.
  kLocking,        ///< Reading and writing; created if missing.
};

/// Opens a file without text conversion; child processes do not inherit it.
/// @return a descriptor.
[[nodiscard]] int open_file(const std::string& path, OpenFor purpose);
void close_file(int descriptor);
/// @return number of bytes, at most as many as one call transfers.
[[nodiscard]] std::int64_t read_bytes(int descriptor, void* bytes, std::size_t count);
[[nodiscard]] std::int64_t write_bytes(int descriptor, const void* bytes, std::size_t count);
/// Variants of read_bytes and write_bytes that start at a file offset, bytes.
[[nodiscard]] std::int64_t read_bytes_at(int descriptor, void* bytes, std::size_t count,
                                         std::int64_t at);
[[nodiscard]] std::int64_t write_bytes_at(int descriptor, const void* bytes, std::size_t count,
                                          std::int64_t at);
/// Moves to the end of the file. @return its size.
[[nodiscard]] std::int64_t seek_end(int descriptor);
[[nodiscard]] int resize_file(int descriptor, std::int64_t bytes);

/// Waits until the content of a file is on disk; `data_only`: not its times.
[[nodiscard]] int flush_to_disk(int descriptor, bool data_only = false);
/// Waits until a folder's directory entries are on disk. No effect on systems that ensure this by
/// themselves.
[[nodiscard]] int flush_folder(const std::string& path);

/// Creates a file without a name, which is gone unless name_file() names it. Not every system and
/// file system has such files.
[[nodiscard]] int create_unnamed(const std::string& folder);
[[nodiscard]] int name_file(int descriptor, const std::string& path);
/// Gives a file the permissions of another one.
[[nodiscard]] int set_permissions(int descriptor, unsigned permissions);
[[nodiscard]] bool may_write(const std::string& path);

[[nodiscard]] int make_folder(const std::string& path);
/// Renames, replacing a file or an empty folder in one step.
[[nodiscard]] int move_over(const std::string& from, const std::string& to);
/// Renames; EEXIST if the new name is taken.
[[nodiscard]] int move_to_new(const std::string& from, const std::string& to);
/// Exchanges two files or folders in one step; ENOSYS or EINVAL if the system cannot.
[[nodiscard]] int exchange(const std::string& a, const std::string& b);
int remove_file(const std::string& path);
int remove_folder(const std::string& path);

enum class LockKind : unsigned char { kAlone, kShared };
/// Locks an open file without waiting. EWOULDBLOCK: another process holds it.
[[nodiscard]] int lock_file(int descriptor, LockKind kind);

/// Whether an errno of a write means that there is no space left.
[[nodiscard]] bool is_out_of_space(int error_number);

[[nodiscard]] int process_id();
/// Called by worker processes. Leaves Ctrl-C to the parent process, which gets it as well. SIGTERM
/// of the parent, however often it arrives, sets a flag; SIGTERM of another process ends the
/// worker. No effect on Windows, where workers are threads.
/// @param stopped  the flag; must exist until the process ends.
void leave_interrupts_to_parent(volatile std::sig_atomic_t& stopped);
/// Name of this computer; empty if unknown.
[[nodiscard]] std::string host_name();
/// File of the running program; empty if unknown.
[[nodiscard]] std::filesystem::path program_file();
/// Physical memory in bytes; 0 if unknown.
[[nodiscard]] std::uint64_t physical_memory();
/// Folder for the data of programs that the user runs.
[[nodiscard]] std::optional<std::filesystem::path> folder_of_user_data();
/// A path with `/` between its parts, also where the system has another separator.
[[nodiscard]] std::string with_slashes(std::string path);

}  // namespace os
}  // namespace retarget
