#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

namespace RETARGET_API retarget {

/// The bytes of a file. std::string would zero its memory before it is filled.
class FileContent {
 public:
  FileContent() = default;
  FileContent(std::unique_ptr<char[]> bytes, std::size_t size)
      : bytes_(std::move(bytes)), size_(size) {}

  [[nodiscard]] std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
};

/// Reads a regular file, a pipe, or standard input for `-`.
///
/// Folders and missing or unreadable files are errors of the given kind. Input of more than `max`
/// bytes, such as an endless pipe, is also an error; the function never allocates more than about
/// three times `max`.
/// @param too_large  hint for the error about too large input.
[[nodiscard]] Result<FileContent> read_file(
    const std::string& path, ErrorKind kind = ErrorKind::kInput,
    std::size_t max = std::numeric_limits<std::size_t>::max(), std::string_view too_large = {});

/// Whether `path` is a regular file or a link to one.
[[nodiscard]] bool is_file(const std::filesystem::path& path);

/// Entries of a folder, sorted by name. Returns the entries read so far if the folder cannot be
/// read.
[[nodiscard]] std::vector<std::filesystem::path> files_in_folder(
    const std::filesystem::path& folder);

/// Whether a file can be opened for reading. The error states the reason.
[[nodiscard]] Result<void> check_readable(const std::string& path, ErrorKind kind);

/// Whether the folder of `path` exists. If not, returns a usage error that names the folder.
[[nodiscard]] Result<void> check_output_folder(const std::string& path);

/// A file that is written completely or not at all.
///
/// Bytes go to a temporary file in the same folder. The temporary file has no name where the file
/// system supports that, so that even a killed process leaves nothing behind. `commit` flushes it
/// to disk and atomically replaces `path`. Destruction without commit discards the file. A symbolic
/// link is kept: the file that it points to is replaced, or created if missing. `-` means standard
/// output. Standard output, pipes and devices receive the bytes immediately.
///
/// After a failed write, later writes and the commit fail too. To get an error instead of being
/// killed at the file size limit, a process must ignore SIGXFSZ.
class OutputFile {
 public:
  [[nodiscard]] static Result<OutputFile> create(const std::string& path);
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] Result<void> write(std::string_view bytes);
  [[nodiscard]] Result<void> commit();

  /// Whether bytes are visible to others as soon as they are written: true for standard output,
  /// pipes and devices.
  [[nodiscard]] bool is_direct() const { return direct_; }

 private:
  OutputFile() = default;
  void discard();

  std::string path_;       // Path as given by the user, for messages.
  std::string target_;     // Path with symbolic links resolved.
  std::string temporary_;  // Empty while the temporary file has no name.
  int descriptor_ = -1;
  bool direct_ = false;  // Standard output, a pipe or a device: no temporary file.
};

/// A name for a temporary file in the folder of the target, short enough for any file system. If
/// the name is taken, callers must try the next number: processes on other machines may share the
/// folder.
[[nodiscard]] std::string temporary_path(const std::string& target, int number);

/// Whether a file name is one that OutputFile gives to temporary files. Only a killed process
/// leaves such a file behind, and only on file systems without unnamed files.
[[nodiscard]] bool is_temporary_name(std::string_view name);

/// Writes `bytes` to `path` completely, or leaves nothing behind; see OutputFile.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view bytes);

/// Whether a name read from a file is safe as the name of a single file or folder: one path
/// component, neither `.` nor `..`, without control characters.
[[nodiscard]] bool is_plain_name(std::string_view name);

/// Whether a path read from a file stays below its folder, judged only by its text: a relative path
/// without `..`. It may contain any character except a zero byte.
[[nodiscard]] bool is_plain_path(std::string_view path);

/// Whether a file is `folder` itself or below it, with symbolic links resolved.
[[nodiscard]] bool is_below(const std::filesystem::path& file, const std::filesystem::path& folder);

/// Whether a plain path relative to a folder stays below it with symbolic links resolved. The last
/// component may not exist.
[[nodiscard]] bool lies_in(const std::filesystem::path& folder, std::string_view path);

/// Maximum size of a settings file (retargeting configuration, profile, gates, path, sidecar) in
/// bytes. The largest real files have a few hundred kilobytes. The limit also stops reading from an
/// endless pipe.
inline constexpr std::size_t kMaxTextBytes = std::size_t{32} << 20U;

}  // namespace retarget
