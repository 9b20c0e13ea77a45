#include "formats/containers/pickle.h"

#include <zlib.h>
#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "base/try.h"
#include "formats/containers/npz.h"
#include "formats/containers/pickle_reader.h"
#include "retarget/bytes.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Kind = PickleNode::Kind;

constexpr std::size_t kMaxUnpacked = std::size_t{1} << 30;
// A file may unpack to this multiple of its size; joblib files of motions stay below 4.
constexpr std::size_t kMaxRatio = 64;
// This much may always be unpacked. Bytes that become doubles take eight times as much memory.
constexpr std::size_t kFreeUnpacked = std::size_t{8} << 20;

bool is_zlib(std::string_view bytes) {
  return bytes.starts_with("\x78\x01") || bytes.starts_with("\x78\x5e") ||
         bytes.starts_with("\x78\x9c") || bytes.starts_with("\x78\xda");
}

// Protocols 0 and 1 have no header. They begin with a dictionary, a list or a class name and end
// with a stop.
bool is_old_pickle(std::string_view bytes) {
  if (!bytes.ends_with('.')) return false;
  for (const std::string_view begin : {"(dp", "(lp", "}q", "]q", "(d", "(l"}) {
    if (bytes.starts_with(begin)) return true;
  }
  // `cnumpy.core.multiarray\n_reconstruct\n`
  if (!bytes.starts_with('c')) return false;
  const auto is_name = [](std::string_view line) {
    return !line.empty() && std::ranges::all_of(line, [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             c == '_' || c == '.';
    });
  };
  const std::size_t first = bytes.find('\n');
  if (first == std::string_view::npos || !is_name(bytes.substr(1, first - 1))) return false;
  const std::size_t second = bytes.find('\n', first + 1);
  return second != std::string_view::npos && is_name(bytes.substr(first + 1, second - first - 1));
}

// Unpacks a whole zlib or gzip stream. Memory grows with the actual output.
Result<std::string> unpack(std::string_view bytes, const std::string& file) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  constexpr int kZlibOrGzip = MAX_WBITS + 32;
  // Sizes in the file may be false, so count the actual output.
  const std::size_t max = std::min(kMaxUnpacked, std::max(kFreeUnpacked, kMaxRatio * bytes.size()));
  z_stream stream{};
  if (inflateInit2(&stream, kZlibOrGzip) != Z_OK) {
    return run_failure(file, "not enough memory to unpack the file");
  }
  std::string unpacked;
  std::size_t fed = 0;
  int state = Z_OK;
  while (state == Z_OK && unpacked.size() <= max) {
    if (stream.avail_in == 0) {
      const std::size_t size = std::min(bytes.size() - fed, kPiece);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + fed));
      stream.avail_in = static_cast<uInt>(size);
      fed += size;
    }
    const std::size_t used = unpacked.size();
    unpacked.resize(used + kPiece);
    stream.next_out = reinterpret_cast<Bytef*>(unpacked.data() + used);
    stream.avail_out = static_cast<uInt>(kPiece);
    state = inflate(&stream, Z_NO_FLUSH);
    unpacked.resize(used + kPiece - stream.avail_out);
  }
  inflateEnd(&stream);
  if (unpacked.size() > max) {
    return input_failure(file,
                         "unpacked, the file has more than " + std::to_string(max) +
                             " bytes, but it has only " + std::to_string(bytes.size()),
                         "its size or compression ratio is implausible for a motion");
  }
  if (state != Z_STREAM_END) {
    return input_failure(file, "the compressed file is damaged or cut off");
  }
  return unpacked;
}

}  // namespace

const PickleNode* PickleDocument::find(const PickleNode& dictionary, std::string_view key) const {
  if (dictionary.kind != Kind::kDict) return nullptr;
  for (std::size_t i = dictionary.items.size(); i >= 2; i -= 2) {
    const PickleNode& found = at(dictionary.items[i - 2]);
    if (found.kind == Kind::kText && found.text == key) return &at(dictionary.items[i - 1]);
  }
  return nullptr;
}

std::vector<std::string> PickleDocument::keys(const PickleNode& dictionary) const {
  std::vector<std::string> names;
  if (dictionary.kind != Kind::kDict) return names;
  for (std::size_t i = 0; i < dictionary.items.size(); i += 2) {
    const PickleNode& key = at(dictionary.items[i]);
    if (key.kind == Kind::kText) names.emplace_back(key.text);
  }
  return names;
}

std::optional<double> PickleDocument::number(const PickleNode& node) const {
  if (node.kind == Kind::kInteger || node.kind == Kind::kBool) {
    return static_cast<double>(node.integer);
  }
  if (node.kind == Kind::kNumber) return node.number;
  if (node.kind != Kind::kArray) return std::nullopt;
  const NpyArray& found = array(node);
  if (!found.is_number() || found.element_count() != 1) return std::nullopt;
  return found.numbers().front();
}

bool looks_like_pickle(std::string_view bytes) {
  if (is_zlib(bytes) || bytes.starts_with("\x1f\x8b") || is_old_pickle(bytes)) return true;
  return bytes.size() >= 2 && bytes[0] == '\x80' && bytes[1] >= 0 && bytes[1] <= 5;
}

namespace {

bool is_compressed(std::string_view bytes) {
  return is_zlib(bytes) || bytes.starts_with("\x1f\x8b");
}

}  // namespace

Result<PickleDocument> read_pickle(std::string_view bytes, const std::string& file) {
  PickleDocument document;
  const std::size_t file_bytes = bytes.size();
  const bool compressed = is_compressed(bytes);
  if (compressed) {
    TRY_ASSIGN(document.unpacked_, unpack(bytes, file));
    // A short string is stored inside its object, so views of it would dangle after a move.
    document.unpacked_.reserve(64);
    bytes = document.unpacked_;
  }
  if (!bytes.starts_with('\x80')) {
    const bool old = is_old_pickle(bytes);
    return input_failure(file,
                         old          ? "the pickle has protocol 0 or 1; 2 to 5 are supported"
                         : compressed ? "the compressed file does not contain a pickle"
                                      : "the file is not a pickle of protocol 2 or later",
                         compressed && !old ? "unpack it and pass the file inside"
                                            : "write it with Python 3's pickle.dump(motion, file)");
  }
  PickleReader reader(bytes, file, document, PickleReader::Dialect::kPlain, file_bytes);
  TRY(reader.read());
  return document;
}

bool is_damaged_pickle(std::string_view bytes) {
  std::string unpacked;
  const std::size_t file_bytes = bytes.size();
  if (is_compressed(bytes)) {
    auto found = unpack(bytes, {});
    if (!found) return true;
    unpacked = *std::move(found);
    bytes = unpacked;
  }
  if (!bytes.starts_with('\x80')) return false;
  PickleDocument document;
  PickleReader reader(bytes, {}, document, PickleReader::Dialect::kPlain, file_bytes);
  return !reader.read() && reader.is_damaged();
}

Result<PickleDocument> read_torch_pickle(std::string bytes, const std::string& file) {
  PickleDocument document;
  document.unpacked_ = std::move(bytes);
  // A short string is stored inside its object, so views of it would dangle after a move.
  document.unpacked_.reserve(64);
  PickleReader reader(document.unpacked_, file, document, PickleReader::Dialect::kTorch);
  TRY(reader.read());
  return document;
}

PickleWriter::PickleWriter() {
  append_opcode(bytes_, PickleOp::kProto);
  bytes_ += '\x04';
}

void PickleWriter::begin_dict() {
  append_opcode(bytes_, PickleOp::kEmptyDict);
  append_opcode(bytes_, PickleOp::kMark);
}

void PickleWriter::end_dict() {
  append_opcode(bytes_, PickleOp::kSetItems);
}

void PickleWriter::begin_list() {
  append_opcode(bytes_, PickleOp::kEmptyList);
  append_opcode(bytes_, PickleOp::kMark);
}

void PickleWriter::end_list() {
  append_opcode(bytes_, PickleOp::kAppends);
}

void PickleWriter::none() {
  append_opcode(bytes_, PickleOp::kNone);
}

void append_integer(std::string& bytes, std::int64_t value) {
  using Limits = std::numeric_limits<std::int32_t>;
  const bool is_short = value >= Limits::min() && value <= Limits::max();
  append_opcode(bytes, is_short ? PickleOp::kBinInt : PickleOp::kLong1);
  if (!is_short) bytes += '\x08';
  append_little_endian(bytes, std::bit_cast<std::uint64_t>(value), is_short ? 4 : 8);
}

void append_number(std::string& bytes, double value) {
  append_opcode(bytes, PickleOp::kBinFloat);
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 7; i >= 0; --i) bytes += static_cast<char>(bits >> (8 * i));
}

void PickleWriter::integer(std::int64_t value) {
  append_integer(bytes_, value);
}

void PickleWriter::number(double value) {
  append_number(bytes_, value);
}

void PickleWriter::text(std::string_view value) {
  const std::string utf8 = valid_utf8(value);
  const bool is_short = utf8.size() < 256;
  append_opcode(bytes_, is_short ? PickleOp::kShortBinUnicode : PickleOp::kBinUnicode8);
  append_little_endian(bytes_, utf8.size(), is_short ? 1 : 8);
  bytes_ += utf8;
}

void PickleWriter::texts(std::span<const std::string> values) {
  begin_list();
  for (const std::string& value : values) text(value);
  end_list();
}

void PickleWriter::bytes(std::string_view value) {
  const bool is_short = value.size() < 256;
  append_opcode(bytes_, is_short ? PickleOp::kShortBinBytes : PickleOp::kBinBytes8);
  append_little_endian(bytes_, value.size(), is_short ? 1 : 8);
  bytes_ += value;
}

void PickleWriter::tuple_of_lengths(std::span<const std::size_t> lengths) {
  append_opcode(bytes_, PickleOp::kMark);
  for (const std::size_t length : lengths) integer(static_cast<std::int64_t>(length));
  append_opcode(bytes_, PickleOp::kTuple);
}

void PickleWriter::global(std::string_view module, std::string_view name) {
  text(module);
  text(name);
  append_opcode(bytes_, PickleOp::kStackGlobal);
}

void PickleWriter::array(const NpyArray& array) {
  // _reconstruct(ndarray, (0,), b'b')
  global("numpy.core.multiarray", "_reconstruct");
  global("numpy", "ndarray");
  integer(0);
  append_opcode(bytes_, PickleOp::kTuple1);
  bytes("b");
  append_opcode(bytes_, PickleOp::kTuple3);
  append_opcode(bytes_, PickleOp::kReduce);
  // State: version, shape, dtype, is Fortran order, elements.
  append_opcode(bytes_, PickleOp::kMark);
  integer(1);
  tuple_of_lengths(array.shape);
  const std::string type = npy_type_text(array);
  global("numpy", "dtype");
  text(std::string_view(type).substr(1));
  append_opcode(bytes_, PickleOp::kNewFalse);
  append_opcode(bytes_, PickleOp::kNewTrue);
  append_opcode(bytes_, PickleOp::kTuple3);
  append_opcode(bytes_, PickleOp::kReduce);
  append_opcode(bytes_, PickleOp::kMark);
  integer(3);
  text(std::string_view(type).substr(0, 1));
  for (int i = 0; i < 3; ++i) none();
  integer(-1);
  integer(-1);
  integer(0);
  append_opcode(bytes_, PickleOp::kTuple);
  append_opcode(bytes_, PickleOp::kBuild);
  append_opcode(bytes_, PickleOp::kNewFalse);
  bytes(array.data);
  append_opcode(bytes_, PickleOp::kTuple);
  append_opcode(bytes_, PickleOp::kBuild);
}

std::string PickleWriter::finish() {
  append_opcode(bytes_, PickleOp::kStop);
  return std::move(bytes_);
}

}  // namespace retarget
