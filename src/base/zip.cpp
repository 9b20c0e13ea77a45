#include "base/zip.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>

#include "base/npy_stream.h"
#include "base/number_text.h"
#include "base/printable.h"
#include "base/try.h"

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
    // libzip would not notice, and what an entry may unpack to depends on it
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
  // libzip may know more methods, as it was built
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
  // libzip compares size and checksum when it meets the end
  char more = 0;
  const zip_int64_t count = zip_fread(file_.get(), &more, 1);
  if (count < 0) return read_failure();
  if (count > 0) return format_failure("its compressed data have the wrong length");
  return {};
}

}  // namespace retarget
