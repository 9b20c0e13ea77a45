#include "base/zip_writer.h"

#include <zlib.h>

#include <cstdint>
#include <utility>

#include "base/byte_order.h"
#include "base/option_name.h"

namespace retarget {
namespace {

// the first of January 1980, the least date that ZIP knows
constexpr std::uint64_t kNoDate = 0x00210000;
constexpr std::uint64_t kZipVersion = 20;
constexpr std::uint64_t kZip64Version = 45;
constexpr std::uint64_t kIn64Bits = 0xFFFFFFFF;  // of a field whose number is elsewhere

struct ZipRecord {
  std::string_view name;
  ZipChecksum content;
  std::uint64_t offset = 0;  // of the local header
};

// what local header and directory have in common, but for the signature
std::string common_fields(const ZipRecord& record, std::uint64_t size, std::size_t extra_size) {
  std::string fields;
  append_little_endian(fields, extra_size > 0 ? kZip64Version : kZipVersion, 2);
  append_little_endian(fields, 0, 4);  // no flags, stored
  append_little_endian(fields, kNoDate, 4);
  append_little_endian(fields, record.content.crc, 4);
  append_little_endian(fields, size, 4);
  append_little_endian(fields, size, 4);
  append_little_endian(fields, record.name.size(), 2);
  append_little_endian(fields, extra_size, 2);
  return fields;
}

// ZIP64's extra field; empty where there is nothing to say
std::string zip64_field(const std::string& numbers) {
  std::string field;
  if (numbers.empty()) return field;
  append_little_endian(field, 1, 2);
  append_little_endian(field, numbers.size(), 2);
  return field + numbers;
}

// the size, packed and unpacked, where it is too large
std::string large_sizes(const ZipRecord& record, std::uint64_t zip64_from) {
  std::string numbers;
  if (record.content.size < zip64_from) return numbers;
  append_little_endian(numbers, record.content.size, 8);
  append_little_endian(numbers, record.content.size, 8);
  return numbers;
}

std::uint64_t plain_number(std::uint64_t number, std::uint64_t zip64_from) {
  return number < zip64_from ? number : kIn64Bits;
}

std::string local_header(const ZipRecord& record, std::uint64_t zip64_from) {
  const std::string extra = zip64_field(large_sizes(record, zip64_from));
  const std::uint64_t size = plain_number(record.content.size, zip64_from);
  std::string header = "PK\x03\x04" + common_fields(record, size, extra.size());
  header += record.name;
  return header + extra;
}

std::string directory_record(const ZipRecord& record, std::uint64_t zip64_from) {
  std::string numbers = large_sizes(record, zip64_from);
  if (record.offset >= zip64_from) append_little_endian(numbers, record.offset, 8);
  const std::string extra = zip64_field(numbers);
  const std::uint64_t size = plain_number(record.content.size, zip64_from);
  std::string bytes = "PK\x01\x02";
  append_little_endian(bytes, extra.empty() ? kZipVersion : kZip64Version, 2);
  bytes += common_fields(record, size, extra.size());
  bytes += std::string(10, '\0');  // no comment, first disk, no attributes
  append_little_endian(bytes, plain_number(record.offset, zip64_from), 4);
  bytes += record.name;
  return bytes + extra;
}

// what a directory of so many files, so large and there, ends with
std::string archive_end(std::uint64_t count, std::uint64_t size, std::uint64_t offset,
                        std::uint64_t zip64_from) {
  std::string end;
  if (size >= zip64_from || offset >= zip64_from) {
    constexpr std::uint64_t kSizeBehind = 44;
    end += "PK\x06\x06";
    append_little_endian(end, kSizeBehind, 8);
    append_little_endian(end, kZip64Version, 2);
    append_little_endian(end, kZip64Version, 2);
    append_little_endian(end, 0, 8);  // first disk
    append_little_endian(end, count, 8);
    append_little_endian(end, count, 8);
    append_little_endian(end, size, 8);
    append_little_endian(end, offset, 8);
    // where that is
    end += "PK\x06\x07";
    append_little_endian(end, 0, 4);
    append_little_endian(end, offset + size, 8);
    append_little_endian(end, 1, 4);
  }
  end += "PK\x05\x06";
  append_little_endian(end, 0, 4);
  append_little_endian(end, count, 2);
  append_little_endian(end, count, 2);
  append_little_endian(end, plain_number(size, zip64_from), 4);
  append_little_endian(end, plain_number(offset, zip64_from), 4);
  append_little_endian(end, 0, 2);
  return end;
}

}  // namespace

void ZipChecksum::add(std::string_view bytes) {
  crc = static_cast<std::uint32_t>(
      crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  size += bytes.size();
}

void ZipChecksum::append(const ZipChecksum& next) {
  crc = static_cast<std::uint32_t>(crc32_combine(crc, next.crc, static_cast<z_off_t>(next.size)));
  size += next.size;
}

void ZipWriter::add(std::string_view name, std::string_view content) {
  ZipRecord record{name, {}, bytes_.size()};
  record.content.add(content);
  bytes_ += local_header(record, kIn64Bits);
  bytes_ += content;
  directory_ += directory_record(record, kIn64Bits);
  ++count_;
}

Result<std::string> ZipWriter::finish() {
  if (bytes_.size() + directory_.size() >= kIn64Bits) {
    return run_failure("", "the motion is too long for one file, which holds up to 4 GiB",
                       "write it in parts, with " OPTION("start") " and " OPTION("end"));
  }
  const std::string end = archive_end(count_, directory_.size(), bytes_.size(), kIn64Bits);
  return std::move(bytes_) + directory_ + end;
}

Result<void> ZipStream::begin(std::string_view name, const ZipChecksum& content) {
  name_ = name;
  expected_ = content;
  found_ = {};
  const ZipRecord record{name_, content, offset_};
  directory_ += directory_record(record, zip64_from_);
  ++count_;
  return put(local_header(record, zip64_from_));
}

Result<void> ZipStream::write(std::string_view bytes) {
  found_.add(bytes);
  return put(bytes);
}

Result<void> ZipStream::end() {
  if (found_ == expected_) return {};
  return run_failure("", "what goes into \"" + name_ + "\" changed while it was read");
}

Result<void> ZipStream::finish() {
  const std::string end = archive_end(count_, directory_.size(), offset_, zip64_from_);
  return put(directory_ + end);
}

Result<void> ZipStream::put(std::string_view bytes) {
  offset_ += bytes.size();
  return write_(bytes);
}

}  // namespace retarget
