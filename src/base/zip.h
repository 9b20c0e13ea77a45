#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

namespace retarget {

/// A file in a ZIP archive, as the central directory tells of it.
struct ZipEntry {
  std::string name;
  unsigned flags = 0;
  unsigned method = 0;  ///< 0 stored, 8 deflate; others exist.
  std::uint32_t crc = 0;
  std::uint64_t packed_size = 0;
  std::uint64_t size = 0;
  std::uint64_t header_offset = 0;  ///< Of the local header in the archive.
};

/// The central directory, found from the archive's end; ZIP64 where it is used. (APPNOTE.TXT 6.3:
/// 4.3.12, 4.3.14-16, 4.5.3.) Local headers are not looked at: numpy writes ZIP64 extras into them
/// whatever the size. Errors of the functions here have a message and a hint only.
[[nodiscard]] Result<std::vector<ZipEntry>> read_zip_directory(std::string_view archive);

/// Unpacks one entry from its beginning on.
class ZipEntryReader {
 public:
  /// Errors: encryption, another method than stored and deflate, a local header that is not there
  /// or is another entry's.
  [[nodiscard]] static Result<ZipEntryReader> open(std::string_view archive, const ZipEntry& entry);
  ~ZipEntryReader();
  ZipEntryReader(ZipEntryReader&&) noexcept;
  ZipEntryReader& operator=(ZipEntryReader&&) noexcept;

  /// The next `size` bytes. Memory grows as they come, so a size that is not true costs nothing.
  [[nodiscard]] Result<std::string> read(std::size_t size);

  /// Checks that everything was read and has the entry's checksum.
  [[nodiscard]] Result<void> finish();

 private:
  struct Inflater;
  ZipEntryReader(std::string_view packed, const ZipEntry& entry);
  [[nodiscard]] Result<std::size_t> fill(char* target, std::size_t size);

  std::string_view packed_;  // what is not yet unpacked, where nothing needs unpacking
  std::uint32_t expected_crc_ = 0;
  std::uint32_t crc_ = 0;
  std::unique_ptr<Inflater> inflater_;  // none: the entry is stored
};

}  // namespace retarget
