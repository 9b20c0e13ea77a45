#include <algorithm>
#include <optional>

#include "base/npy_stream.h"
#include "base/try.h"
#include "base/zip.h"

namespace retarget {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kEndSignature = "PK\x05\x06"sv;
constexpr std::string_view kEnd64Signature = "PK\x06\x06"sv;
constexpr std::string_view kLocator64Signature = "PK\x06\x07"sv;
constexpr std::string_view kEntrySignature = "PK\x01\x02"sv;
constexpr std::size_t kEndSize = 22;
constexpr std::size_t kEnd64Size = 56;
constexpr std::size_t kLocator64Size = 20;
constexpr std::size_t kEntrySize = 46;
constexpr std::size_t kMostComment = 65535;
constexpr std::uint64_t kIn64 = 0xFFFFFFFF;  // the value stands in a ZIP64 record
constexpr std::uint64_t kShortIn64 = 0xFFFF;

// where the central directory lies, and how much there is in it
struct Place {
  std::uint64_t entries = 0;
  std::uint64_t size = 0;
  std::uint64_t offset = 0;
  std::size_t end = 0;  // of the directory: where the records after it begin
};

Failure damaged(const std::string& what) {
  return format_failure("the ZIP archive is damaged: " + what);
}

// the last record whose comment reaches to the end of the archive
std::optional<std::size_t> find_end_record(std::string_view archive) {
  if (archive.size() < kEndSize) return std::nullopt;
  const std::size_t last = archive.size() - kEndSize;
  const std::size_t first = last - std::min(last, kMostComment);
  for (std::size_t at = last + 1; at-- > first;) {
    if (archive.substr(at, kEndSignature.size()) == kEndSignature &&
        at + kEndSize + little_endian(archive, at + 20, 2) == archive.size()) {
      return at;
    }
  }
  return std::nullopt;
}

bool has_record(std::string_view archive, std::uint64_t at, std::string_view signature,
                std::size_t size) {
  return at <= archive.size() && archive.size() - at >= size &&
         archive.substr(at, signature.size()) == signature;
}

// the ZIP64 record of the end, which takes the place of the short one
Result<Place> place_from_zip64(std::string_view archive, std::size_t end_record) {
  if (end_record < kLocator64Size ||
      !has_record(archive, end_record - kLocator64Size, kLocator64Signature, kLocator64Size)) {
    return damaged("no ZIP64 locator before its end");
  }
  const std::uint64_t at = little_endian(archive, end_record - kLocator64Size + 8, 8);
  if (at > end_record - kLocator64Size || !has_record(archive, at, kEnd64Signature, kEnd64Size)) {
    return damaged("no ZIP64 record at byte " + std::to_string(at));
  }
  const std::size_t begin = at;
  return Place{little_endian(archive, begin + 32, 8), little_endian(archive, begin + 40, 8),
               little_endian(archive, begin + 48, 8), begin};
}

Result<Place> find_directory(std::string_view archive) {
  const auto end = find_end_record(archive);
  if (!end) {
    return format_failure("no ZIP directory at its end",
                          "the file was cut off, or it is no NPZ file (as numpy.savez writes it)");
  }
  Place place{little_endian(archive, *end + 10, 2), little_endian(archive, *end + 12, 4),
              little_endian(archive, *end + 16, 4), *end};
  if (little_endian(archive, *end + 4, 2) != little_endian(archive, *end + 6, 2)) {
    return format_failure("archives of several volumes are not supported");
  }
  const bool in64 = place.entries == kShortIn64 || place.size == kIn64 || place.offset == kIn64;
  if (in64) {
    TRY_ASSIGN(const auto long_place, place_from_zip64(archive, *end));
    place = long_place;
  }
  if (place.offset > place.end || place.size != place.end - place.offset) {
    return damaged("its directory should have " + std::to_string(place.size) + " bytes from byte " +
                   std::to_string(place.offset) + " up to byte " + std::to_string(place.end));
  }
  return place;
}

// fills in the values that stand in the ZIP64 extra, in a fixed order; false: they are not there
bool take_zip64_values(std::string_view extra, ZipEntry& entry) {
  constexpr std::uint64_t kZip64Tag = 1;
  std::string_view values;
  while (extra.size() >= 4) {
    const std::uint64_t tag = little_endian(extra, 0, 2);
    const std::size_t size = little_endian(extra, 2, 2);
    if (size > extra.size() - 4) break;
    if (tag == kZip64Tag) values = extra.substr(4, size);
    extra.remove_prefix(4 + size);
  }
  for (std::uint64_t* value : {&entry.size, &entry.packed_size, &entry.header_offset}) {
    if (*value != kIn64) continue;
    if (values.size() < 8) return false;
    *value = little_endian(values, 0, 8);
    values.remove_prefix(8);
  }
  return true;
}

// the entry at the beginning of `rest`, which is shortened by it
Result<ZipEntry> take_entry(std::string_view& rest) {
  if (rest.size() < kEntrySize || !rest.starts_with(kEntrySignature)) {
    return damaged("its directory ends early");
  }
  const std::size_t name_size = little_endian(rest, 28, 2);
  const std::size_t extra_size = little_endian(rest, 30, 2);
  const std::size_t total = kEntrySize + name_size + extra_size + little_endian(rest, 32, 2);
  if (total > rest.size()) return damaged("its directory ends early");

  ZipEntry entry;
  entry.name = rest.substr(kEntrySize, name_size);
  entry.flags = little_endian(rest, 8, 2);
  entry.method = little_endian(rest, 10, 2);
  entry.crc = little_endian(rest, 16, 4);
  entry.packed_size = little_endian(rest, 20, 4);
  entry.size = little_endian(rest, 24, 4);
  entry.header_offset = little_endian(rest, 42, 4);
  if (!take_zip64_values(rest.substr(kEntrySize + name_size, extra_size), entry)) {
    return damaged("an entry lacks its ZIP64 sizes");
  }
  rest.remove_prefix(total);
  return entry;
}

}  // namespace

Result<std::vector<ZipEntry>> read_zip_directory(std::string_view archive) {
  TRY_ASSIGN(const auto place, find_directory(archive));
  std::string_view rest = archive.substr(place.offset, place.size);
  std::vector<ZipEntry> entries;
  while (!rest.empty()) {
    TRY_ASSIGN(auto entry, take_entry(rest));
    entries.push_back(std::move(entry));
  }
  if (entries.size() != place.entries) {
    return damaged("its directory claims " + std::to_string(place.entries) + " entries and has " +
                   std::to_string(entries.size()));
  }
  return entries;
}

}  // namespace retarget
