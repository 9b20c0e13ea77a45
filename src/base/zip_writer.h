#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "retarget/error.h"

namespace retarget {

/// CRC-32 and size of bytes that come in pieces.
struct ZipChecksum {
  std::uint32_t crc = 0;
  std::uint64_t size = 0;

  void add(std::string_view bytes);
  /// As if the bytes of the other had been added.
  void append(const ZipChecksum& next);
  bool operator==(const ZipChecksum&) const = default;
};

/// Builds a ZIP archive of files that are not compressed. Entries have no date, so that the same
/// files give the same bytes.
class ZipWriter {
 public:
  void add(std::string_view name, std::string_view content);
  /// The whole archive. Errors (kRun): 4 GiB or more, which plain ZIP archives cannot hold.
  [[nodiscard]] Result<std::string> finish();

 private:
  std::string bytes_;
  std::string directory_;
  std::uint64_t count_ = 0;
};

/// Takes the next bytes of a file.
using WriteBytes = std::function<Result<void>(std::string_view bytes)>;

/// A ZIP archive as of ZipWriter that goes out as it comes, of files whose sizes and checksums are
/// known before; ZIP64 where sizes need it.
class ZipStream {
 public:
  /// @param zip64_from  what plain fields do not hold; less only to try ZIP64 with small files.
  explicit ZipStream(WriteBytes write, std::uint64_t zip64_from = 0xFFFFFFFF)
      : write_(std::move(write)), zip64_from_(zip64_from) {}

  /// Begins a file, whose content must be as said.
  [[nodiscard]] Result<void> begin(std::string_view name, const ZipChecksum& content);
  [[nodiscard]] Result<void> write(std::string_view bytes);
  /// Ends it. Errors (kRun): its content is not what `begin` was told.
  [[nodiscard]] Result<void> end();
  /// Ends the archive.
  [[nodiscard]] Result<void> finish();

 private:
  [[nodiscard]] Result<void> put(std::string_view bytes);

  WriteBytes write_;
  std::uint64_t zip64_from_;
  std::uint64_t offset_ = 0;  // in the archive
  std::string name_;          // of the file that was begun
  ZipChecksum expected_, found_;
  std::string directory_;
  std::uint64_t count_ = 0;
};

}  // namespace retarget
