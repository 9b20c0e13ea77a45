#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/error.h"

namespace retarget {

/// CRC-32 and size of bytes that are added in chunks.
struct ZipChecksum {
  std::uint32_t crc = 0;
  std::uint64_t size = 0;

  void add(std::string_view bytes);
  /// Appends the bytes summarised by `next`.
  void append(const ZipChecksum& next);
  bool operator==(const ZipChecksum&) const = default;
};

/// Builds a ZIP archive of uncompressed files. Entries have no date, so equal files give equal
/// bytes.
class ZipWriter {
 public:
  void add(std::string_view name, std::string_view content);
  /// Returns the whole archive. Errors (kRun): 4 GiB or more, which plain ZIP archives do not
  /// support.
  [[nodiscard]] Result<std::string> finish();

 private:
  std::string bytes_;
  std::string directory_;
  std::uint64_t count_ = 0;
};

/// Receives the next bytes of a file.
using WriteBytes = std::function<Result<void>(std::string_view bytes)>;

/// Writes the same ZIP archive as ZipWriter as a stream. Size and checksum of each file must be
/// known in advance. Uses ZIP64 when sizes require it.
class ZipStream {
 public:
  /// @param zip64_from  size from which ZIP64 is used; smaller values serve to test it with small
  ///                    files.
  explicit ZipStream(WriteBytes write, std::uint64_t zip64_from = 0xFFFFFFFF)
      : write_(std::move(write)), zip64_from_(zip64_from) {}

  /// Begins a file with this size and checksum.
  [[nodiscard]] Result<void> begin(std::string_view name, const ZipChecksum& content);
  [[nodiscard]] Result<void> write(std::string_view bytes);
  /// Ends the file. Errors (kRun): the bytes written do not match the checksum given to `begin`.
  [[nodiscard]] Result<void> end();
  /// Ends the archive.
  [[nodiscard]] Result<void> finish();

 private:
  [[nodiscard]] Result<void> put(std::string_view bytes);

  WriteBytes write_;
  std::uint64_t zip64_from_;
  std::uint64_t offset_ = 0;  // Offset in the archive.
  std::string name_;          // Name of the current file.
  ZipChecksum expected_, found_;
  std::string directory_;
  std::uint64_t count_ = 0;
};

}  // namespace retarget
