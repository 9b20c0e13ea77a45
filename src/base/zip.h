#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

struct zip;
struct zip_file;

namespace retarget {

/// A file in a ZIP archive, as the archive's directory tells of it.
struct ZipEntry {
  std::string name;  ///< The bytes of it, whatever their encoding.
  std::uint64_t packed_size = 0;
  std::uint64_t size = 0;
};

/// Unpacks one entry from its beginning on. Errors have a message and a hint only.
class ZipEntryReader {
 public:
  /// The next `size` bytes. Memory grows as they come, so a size that is not true costs nothing.
  [[nodiscard]] Result<std::string> read(std::size_t size);

  /// Checks that everything was read and has the entry's size and checksum.
  [[nodiscard]] Result<void> finish();

 private:
  friend class ZipArchive;
  explicit ZipEntryReader(zip_file* file);
  [[nodiscard]] Failure read_failure();
  std::shared_ptr<zip_file> file_;
};

/// A ZIP archive in memory, read by libzip; ZIP64 where it is used. One thread at a time.
class ZipArchive {
 public:
  /// Reads the directory, whose entries together may not claim more packed bytes than there are.
  /// What a local header says beside is not looked at: contents are held against their checksums.
  /// Errors have a message and a hint only.
  /// @param bytes  must outlive the archive, as that must outlive its readers.
  [[nodiscard]] static Result<ZipArchive> open(std::string_view bytes);

  [[nodiscard]] const std::vector<ZipEntry>& entries() const { return entries_; }

  /// Errors: encryption, another method than stored and deflate.
  [[nodiscard]] Result<ZipEntryReader> entry_reader(std::size_t index) const;

 private:
  std::shared_ptr<zip> archive_;
  std::vector<ZipEntry> entries_;
};

}  // namespace retarget
