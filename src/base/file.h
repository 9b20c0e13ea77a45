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

namespace retarget {

/// Bytes that were read. Not a std::string, which would clear its memory before it is filled.
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

/// The whole content of a regular file, a pipe or, for `-`, of standard input.
///
/// Folders, missing and unreadable files are errors of the given kind, and so are files of more
/// than `most` bytes, which a pipe without an end is in the end: no more than about three times
/// `most` is ever taken.
/// @param too_large  hint of the error for such files.
[[nodiscard]] Result<FileContent> read_file(
    const std::string& path, ErrorKind kind = ErrorKind::kInput,
    std::size_t max = std::numeric_limits<std::size_t>::max(), std::string_view too_large = {});

/// Whether there is a regular file, or a link to one.
[[nodiscard]] bool is_file(const std::filesystem::path& path);

/// What lies in a folder, sorted by name; as far as it can be read.
[[nodiscard]] std::vector<std::filesystem::path> files_in_folder(
    const std::filesystem::path& folder);

/// Whether a file can be opened for reading; the error says why not.
[[nodiscard]] Result<void> check_readable(const std::string& path, ErrorKind kind);

/// Whether the folder that would hold `path` exists; a usage error naming it when it does not.
[[nodiscard]] Result<void> check_output_folder(const std::string& path);

/// A file that appears whole or not at all.
///
/// Bytes go to a temporary file in the same folder (without a name where the file system can do
/// that, so that not even a killed process leaves one behind); `commit` flushes it to the disk and
/// puts it in the place of `path` in one step. Destroyed without commit, nothing remains. A
/// symbolic link is kept, and the file it points to is written, made if need be. `-` means
/// standard output; it, pipes and devices get the bytes as they come.
///
/// Once a write has failed the file is given up: later writes and the commit fail too. A process
/// that would rather have an error than die of a file size limit must ignore SIGXFSZ.
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

  /// Whether bytes are seen by others as they are written: on standard output, in pipes and
  /// devices.
  [[nodiscard]] bool is_direct() const { return direct_; }

 private:
  OutputFile() = default;
  void discard();

  std::string path_;       // as the user named it, for messages
  std::string target_;     // with symbolic links followed
  std::string temporary_;  // empty while the temporary file has no name
  int descriptor_ = -1;
  bool direct_ = false;  // standard output, a pipe or a device: no temporary file
};

/// A name for what is not whole yet, beside the target and short enough for any folder. Who uses it
/// must try the next number when it is taken, as processes of other machines may share the folder.
[[nodiscard]] std::string temporary_path(const std::string& target, int number);

/// Whether a file's name is one that OutputFile gives to what is not whole yet. Such a file is left
/// behind only by a process that was killed, on file systems without nameless files.
[[nodiscard]] bool is_temporary_name(std::string_view name);

/// Writes `bytes` as the whole content of `path`, or leaves no trace; see OutputFile.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view bytes);

}  // namespace retarget
