#include <zlib.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "base/npy_stream.h"
#include "base/try.h"
#include "base/zip.h"

namespace retarget {
namespace {

constexpr std::string_view kLocalSignature("PK\x03\x04", 4);
constexpr std::size_t kLocalSize = 30;
constexpr unsigned kEncryptedFlag = 1;
constexpr unsigned kStored = 0;
constexpr unsigned kDeflated = 8;

// the packed bytes of an entry; its local header says only where they begin
Result<std::string_view> packed_bytes(std::string_view archive, const ZipEntry& entry) {
  const auto damaged = [](const std::string& what) {
    return format_failure("the ZIP archive is damaged: " + what);
  };
  const std::uint64_t at = entry.header_offset;
  if (at > archive.size() || archive.size() - at < kLocalSize ||
      archive.substr(at, kLocalSignature.size()) != kLocalSignature) {
    return damaged("no local header at byte " + std::to_string(at));
  }
  std::string_view rest = archive.substr(at);
  const std::size_t name_size = little_endian(rest, 26, 2);
  const std::size_t begin = kLocalSize + name_size + little_endian(rest, 28, 2);
  if (begin > rest.size() || rest.substr(kLocalSize, name_size) != entry.name) {
    return damaged("the local header at byte " + std::to_string(at) + " is another one");
  }
  rest.remove_prefix(begin);
  if (entry.packed_size > rest.size()) {
    return damaged("expected " + std::to_string(entry.packed_size) + " packed bytes, found " +
                   std::to_string(rest.size()));
  }
  return rest.substr(0, entry.packed_size);
}

uInt as_chunk(std::size_t size) {
  return static_cast<uInt>(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
}

}  // namespace

// zlib's state must not move, as it points to itself
struct ZipEntryReader::Inflater {
  z_stream stream{};
  bool ready = false;
  bool ended = false;

  Inflater() {
    // a negative window size: deflate data without a header of zlib's
    ready = inflateInit2(&stream, -MAX_WBITS) == Z_OK;
  }
  ~Inflater() {
    if (ready) inflateEnd(&stream);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
};

ZipEntryReader::ZipEntryReader(std::string_view packed, const ZipEntry& entry)
    : packed_(packed), expected_crc_(entry.crc) {
  if (entry.method == kDeflated) inflater_ = std::make_unique<Inflater>();
}
ZipEntryReader::~ZipEntryReader() = default;
ZipEntryReader::ZipEntryReader(ZipEntryReader&&) noexcept = default;
ZipEntryReader& ZipEntryReader::operator=(ZipEntryReader&&) noexcept = default;

Result<ZipEntryReader> ZipEntryReader::open(std::string_view archive, const ZipEntry& entry) {
  if ((entry.flags & kEncryptedFlag) != 0) return format_failure("it is encrypted");
  if (entry.method != kStored && entry.method != kDeflated) {
    return format_failure(
        "its compression (ZIP method " + std::to_string(entry.method) + ") is not supported",
        "numpy.savez and numpy.savez_compressed write what is read here");
  }
  TRY_ASSIGN(const auto packed, packed_bytes(archive, entry));
  if (entry.method == kStored && entry.size != entry.packed_size) {
    return format_failure("it is not compressed, but has " + std::to_string(entry.packed_size) +
                          " bytes packed and " + std::to_string(entry.size) + " unpacked");
  }
  ZipEntryReader reader(packed, entry);
  if (reader.inflater_ && !reader.inflater_->ready) {
    return format_failure("zlib cannot start: out of memory");
  }
  return reader;
}

// unpacks up to `size` bytes; fewer only where the data end
Result<std::size_t> ZipEntryReader::fill(char* target, std::size_t size) {
  if (!inflater_) {
    const std::size_t count = std::min(size, packed_.size());
    std::copy_n(packed_.data(), count, target);
    packed_.remove_prefix(count);
    return count;
  }
  z_stream& stream = inflater_->stream;
  std::size_t done = 0;
  while (done < size && !inflater_->ended) {
    const uInt given = as_chunk(packed_.size());
    const uInt room = as_chunk(size - done);
    // zlib does not write to its input
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed_.data()));
    stream.avail_in = given;
    stream.next_out = reinterpret_cast<Bytef*>(target + done);
    stream.avail_out = room;
    const int state = inflate(&stream, Z_NO_FLUSH);
    const uInt taken = given - stream.avail_in;
    const uInt made = room - stream.avail_out;
    packed_.remove_prefix(taken);
    done += made;
    inflater_->ended = state == Z_STREAM_END;
    // no progress: the packed data end in the middle
    if (state == Z_BUF_ERROR || (state == Z_OK && taken == 0 && made == 0)) break;
    if (state != Z_OK && state != Z_STREAM_END) {
      return format_failure("its compressed data are damaged");
    }
  }
  return done;
}

Result<std::string> ZipEntryReader::read(std::size_t size) {
  constexpr std::size_t kFirstChunk = 65536;
  std::string bytes;
  while (bytes.size() < size) {
    const std::size_t begin = bytes.size();
    const std::size_t chunk = std::min(size - begin, std::max(kFirstChunk, begin));
    bytes.resize(begin + chunk);
    TRY_ASSIGN(const auto count, fill(bytes.data() + begin, chunk));
    if (count < chunk) {
      return format_failure("it ends early: expected " + bytes_text(size) + ", found " +
                            std::to_string(begin + count));
    }
  }
  crc_ = static_cast<std::uint32_t>(
      crc32_z(crc_, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  return bytes;
}

Result<void> ZipEntryReader::finish() {
  char more = 0;
  TRY_ASSIGN(const auto count, fill(&more, 1));
  const bool ended = !inflater_ || inflater_->ended;
  if (count > 0 || !packed_.empty() || !ended) {
    return format_failure("its packed data do not end where it ends");
  }
  if (crc_ != expected_crc_) {
    return format_failure("its bytes disagree with their checksum: the file is damaged");
  }
  return {};
}

}  // namespace retarget
