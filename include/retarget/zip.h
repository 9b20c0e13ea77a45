#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"
#include "retarget/export.h"

struct zip;
struct zip_file;

namespace RETARGET_API retarget {

/// A file in a ZIP archive, as the archive's directory describes it.
struct ZipEntry {
  std::string name;  ///< Raw bytes in an unspecified encoding.
  std::uint64_t packed_size = 0;
  std::uint64_t size = 0;
};

/// Unpacks one entry sequentially. Errors have only a message and a hint.
class ZipEntryReader {
 public:
  /// Reads the next `size` bytes. Memory grows as they arrive, so a false size costs nothing.
  [[nodiscard]] Result<std::string> read(std::size_t size);

  /// Checks that everything was read and that size and checksum match.
  [[nodiscard]] Result<void> finish();

 private:
  friend class ZipArchive;
  explicit ZipEntryReader(zip_file* file);
  [[nodiscard]] Failure read_failure();
  std::shared_ptr<zip_file> file_;
};

/// A ZIP archive in memory, with ZIP64, read by libzip. Not thread-safe.
class ZipArchive {
 public:
  /// Reads the directory. The packed sizes of all entries together must not exceed the size of the
  /// archive. Local headers are otherwise ignored; contents are verified by their checksums. Errors
  /// have only a message and a hint.
  /// @param bytes  must outlive the archive, which must outlive its readers.
  [[nodiscard]] static Result<ZipArchive> open(std::string_view bytes);

  [[nodiscard]] const std::vector<ZipEntry>& entries() const { return entries_; }

  /// Errors: an encrypted entry, or a compression method other than stored and deflate.
  [[nodiscard]] Result<ZipEntryReader> entry_reader(std::size_t index) const;

 private:
  std::shared_ptr<zip> archive_;
  std::vector<ZipEntry> entries_;
};

}  // namespace retarget
