#include "retarget/zip.h"

#include <fmt/format.h>
#include <zip.h>
#include <zlib.h>
#include <algorithm>
#include <utility>

#include "base/option_name.h"
#include "base/try.h"
#include "formats/containers/npy.h"
#include "formats/containers/zip_writer.h"
#include "retarget/bytes.h"
#include "retarget/text.h"

namespace retarget {
namespace {

Failure damaged_archive(zip_error_t& error) {
  return format_failure(fmt::format("the ZIP archive is damaged: {}", zip_error_strerror(&error)));
}

Result<zip_stat_t> directory_entry(zip_t* archive, std::size_t index) {
  zip_stat_t entry;
  constexpr zip_uint64_t kNeeded =
      ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD;
  if (zip_stat_index(archive, index, ZIP_FL_ENC_RAW, &entry) != 0) {
    return damaged_archive(*zip_get_error(archive));
  }
  if ((entry.valid & kNeeded) != kNeeded) {
    return format_failure("the ZIP archive is damaged: an entry has no name or no size");
  }
  return entry;
}

}  // namespace

Result<ZipArchive> ZipArchive::open(std::string_view bytes) {
  zip_error_t error;
  zip_error_init(&error);
  const std::shared_ptr<zip_error_t> cleared(&error, zip_error_fini);
  zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  if (source == nullptr) return damaged_archive(error);
  ZipArchive archive;
  archive.archive_.reset(zip_open_from_source(source, ZIP_RDONLY, &error), [](zip_t* opened) {
    if (opened != nullptr) zip_discard(opened);
  });
  zip_t* const opened = archive.archive_.get();
  if (opened == nullptr) {
    zip_source_free(source);
    if (zip_error_code_zip(&error) != ZIP_ER_NOZIP) return damaged_archive(error);
    return format_failure(
        "no ZIP directory at its end",
        "the file was cut off, or it is not an NPZ file (as written by numpy.savez)");
  }
  std::uint64_t unclaimed = bytes.size();
  const zip_int64_t count = zip_get_num_entries(opened, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    TRY_ASSIGN(const zip_stat_t entry, directory_entry(opened, i));
    // libzip does not check this sum, and the limits on unpacking depend on it.
    if (entry.comp_size > unclaimed) {
      return format_failure(fmt::format(
          "the ZIP archive is damaged: expected {} packed bytes of \"{}\", found {} at most",
          entry.comp_size, printable(entry.name), unclaimed));
    }
    unclaimed -= entry.comp_size;
    archive.entries_.push_back({entry.name, entry.comp_size, entry.size});
  }
  return archive;
}

Result<ZipEntryReader> ZipArchive::entry_reader(std::size_t index) const {
  TRY_ASSIGN(const zip_stat_t entry, directory_entry(archive_.get(), index));
  if ((entry.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && entry.encryption_method != ZIP_EM_NONE) {
    return format_failure("it is encrypted");
  }
  // libzip may support further methods, depending on its build.
  if (entry.comp_method != ZIP_CM_STORE && entry.comp_method != ZIP_CM_DEFLATE) {
    return format_failure(
        fmt::format("its compression (ZIP method {}) is not supported", entry.comp_method),
        "save it with numpy.savez or numpy.savez_compressed");
  }
  if (entry.comp_method == ZIP_CM_STORE && entry.size != entry.comp_size) {
    return format_failure(
        fmt::format("it is not compressed, but has {} bytes packed and {} unpacked",
                    entry.comp_size, entry.size));
  }
  zip_file_t* const file = zip_fopen_index(archive_.get(), index, 0);
  if (file == nullptr) return damaged_archive(*zip_get_error(archive_.get()));
  return ZipEntryReader(file);
}

ZipEntryReader::ZipEntryReader(zip_file* file) : file_(file, zip_fclose) {}

Failure ZipEntryReader::read_failure() {
  switch (zip_error_code_zip(zip_file_get_error(file_.get()))) {
    case ZIP_ER_CRC:
      return format_failure("its checksum does not match: the file is damaged");
    case ZIP_ER_INCONS:
      return format_failure("its compressed data have the wrong length");
    default:
      return format_failure("its compressed data are damaged");
  }
}

Result<std::string> ZipEntryReader::read(std::size_t size) {
  constexpr std::size_t kFirstChunk = 65536;
  std::string bytes;
  while (bytes.size() < size) {
    const std::size_t begin = bytes.size();
    const std::size_t chunk = std::min(size - begin, std::max(kFirstChunk, begin));
    bytes.resize(begin + chunk);
    const zip_int64_t count = zip_fread(file_.get(), bytes.data() + begin, chunk);
    if (count < 0) return read_failure();
    if (static_cast<std::size_t>(count) < chunk) {
      return format_failure(fmt::format("it is truncated: expected {}, found {}",
                                        count_text(size, "byte"), begin + count));
    }
  }
  return bytes;
}

Result<void> ZipEntryReader::finish() {
  // libzip verifies size and checksum when it reaches the end of the entry.
  char more = 0;
  const zip_int64_t count = zip_fread(file_.get(), &more, 1);
  if (count < 0) return read_failure();
  if (count > 0) return format_failure("its compressed data have the wrong length");
  return {};
}

namespace {

// 1 January 1980, the earliest date of the ZIP format.
constexpr std::uint64_t kNoDate = 0x00210000;
constexpr std::uint64_t kZipVersion = 20;
constexpr std::uint64_t kZip64Version = 45;
constexpr std::uint64_t kIn64Bits = 0xFFFFFFFF;  // The value is in the ZIP64 record.

struct ZipRecord {
  std::string_view name;
  ZipChecksum content;
  std::uint64_t offset = 0;  // Offset of the local header.
};

// The fields that local header and directory entry share, after the signature.
std::string common_fields(const ZipRecord& record, std::uint64_t size, std::size_t extra_size) {
  std::string fields;
  append_little_endian(fields, extra_size > 0 ? kZip64Version : kZipVersion, 2);
  append_little_endian(fields, 0, 4);  // No flags, method stored.
  append_little_endian(fields, kNoDate, 4);
  append_little_endian(fields, record.content.crc, 4);
  append_little_endian(fields, size, 4);
  append_little_endian(fields, size, 4);
  append_little_endian(fields, record.name.size(), 2);
  append_little_endian(fields, extra_size, 2);
  return fields;
}

// ZIP64 extra field; empty when no number needs it.
std::string zip64_field(const std::string& numbers) {
  std::string field;
  if (numbers.empty()) return field;
  append_little_endian(field, 1, 2);
  append_little_endian(field, numbers.size(), 2);
  return field + numbers;
}

// Packed and unpacked size for the extra field, if they need ZIP64.
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
  bytes += std::string(10, '\0');  // No comment, first disk, no attributes.
  append_little_endian(bytes, plain_number(record.offset, zip64_from), 4);
  bytes += record.name;
  return bytes + extra;
}

// The end of the directory, with the ZIP64 records when `size` or `offset` requires them.
std::string archive_end(std::uint64_t count, std::uint64_t size, std::uint64_t offset,
                        std::uint64_t zip64_from) {
  std::string end;
  if (size >= zip64_from || offset >= zip64_from) {
    constexpr std::uint64_t kSizeBehind = 44;
    end += "PK\x06\x06";
    append_little_endian(end, kSizeBehind, 8);
    append_little_endian(end, kZip64Version, 2);
    append_little_endian(end, kZip64Version, 2);
    append_little_endian(end, 0, 8);  // First disk.
    append_little_endian(end, count, 8);
    append_little_endian(end, count, 8);
    append_little_endian(end, size, 8);
    append_little_endian(end, offset, 8);
    // Locator of the ZIP64 record.
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
    return run_failure("", "the motion exceeds the file size limit of 4 GiB",
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
  return run_failure("", "the input of \"" + name_ + "\" changed while it was read");
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
