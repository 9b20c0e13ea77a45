#include "base/zip_writer.h"

#include <zlib.h>

#include <cstdint>
#include <utility>

#include "base/little_endian.h"
#include "base/option_name.h"

namespace retarget {
namespace {

// the first of January 1980, the least date that ZIP knows
constexpr std::uint64_t kNoDate = 0x00210000;
constexpr std::uint64_t kZipVersion = 20;

}  // namespace

void ZipWriter::add(std::string_view name, std::string_view content) {
  const std::uint64_t offset = bytes_.size();
  std::string entry;  // what local header and directory have in common
  append_little_endian(entry, kZipVersion, 2);
  append_little_endian(entry, 0, 4);  // no flags, stored
  append_little_endian(entry, kNoDate, 4);
  append_little_endian(
      entry, crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()), 4);
  append_little_endian(entry, content.size(), 4);
  append_little_endian(entry, content.size(), 4);
  append_little_endian(entry, name.size(), 2);
  append_little_endian(entry, 0, 2);  // no extra field
  bytes_ += "PK\x03\x04";
  bytes_ += entry;
  bytes_ += name;
  bytes_ += content;
  directory_ += "PK\x01\x02";
  append_little_endian(directory_, kZipVersion, 2);
  directory_ += entry;
  directory_ += std::string(10, '\0');  // no comment, first disk, no attributes
  append_little_endian(directory_, offset, 4);
  directory_ += name;
  ++count_;
}

Result<std::string> ZipWriter::finish() {
  constexpr std::uint64_t kMaxZipBytes = 0xFFFFFFFF;
  if (bytes_.size() + directory_.size() >= kMaxZipBytes) {
    return run_failure("", "the motion is too long for one file, which holds up to 4 GiB",
                       "write it in parts, with " OPTION("start") " and " OPTION("end"));
  }
  std::string end = "PK\x05\x06";
  append_little_endian(end, 0, 4);
  append_little_endian(end, static_cast<std::uint64_t>(count_), 2);
  append_little_endian(end, static_cast<std::uint64_t>(count_), 2);
  append_little_endian(end, directory_.size(), 4);
  append_little_endian(end, bytes_.size(), 4);
  append_little_endian(end, 0, 2);
  return std::move(bytes_) + directory_ + end;
}

}  // namespace retarget
