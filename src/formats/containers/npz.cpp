#include "formats/containers/npz.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <map>

#include "base/try.h"
#include "formats/containers/file_kind.h"
#include "retarget/bytes.h"
#include "retarget/text.h"
#include "retarget/zip.h"

namespace retarget {
namespace {

constexpr std::string_view kSuffix = ".npy";

// Hint for converting another type of file to NPZ.
std::string_view remedy_for(const FileType& type) {
  switch (type.kind) {
    case FileKind::kNpy:
      return "put the arrays into one file with numpy.savez";
    case FileKind::kPickle:
      return "save its arrays with numpy.savez; nothing is ever unpickled, as that would run code "
             "from the file";
    case FileKind::kGzip:
      return "unpack it and pass the .npz file inside";
    default:
      return type.hint;
  }
}

constexpr std::string_view kBombHint =
    "the compression ratio is implausible for a motion; numpy.savez writes without compression";

// Whether the ratio of unpacked to packed bytes is suspicious.
bool is_too_much(std::uint64_t unpacked, std::uint64_t packed, std::uint64_t free,
                 std::uint64_t ratio) {
  return unpacked > free && unpacked / ratio > packed;
}

bool has_control_bytes(std::string_view name) {
  return std::ranges::any_of(
      name, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

}  // namespace

struct NpzFile::Contents {
  std::string file_name;
  NpzReadOptions options;
  ZipArchive archive;
  std::map<std::string, std::size_t, std::less<>> index;  // Index in the archive, by name.

  // Adds the file and, if given, the array to an error.
  [[nodiscard]] Failure complete(Error error, std::string_view array = {}) const {
    error.kind = options.error_kind;
    error.location.file = file_name;
    if (!array.empty()) error.message = "array \"" + std::string(array) + "\": " + error.message;
    return failure(std::move(error));
  }

  // One-byte numbers grow to eight-byte doubles, so even an uncompressed array can exhaust memory.
  [[nodiscard]] Result<void> check_numbers(std::string_view array, const NpyLayout& layout,
                                           const ZipEntry& entry) const {
    if (!layout.array.is_number()) return {};
    const std::uint64_t count = layout.data_size / layout.array.item_size;
    const std::uint64_t max = options.max_number_bytes / sizeof(double);
    const std::string what = "its " + std::to_string(count) + " numbers need " +
                             count_text(count * sizeof(double), "byte") + " of memory, ";
    if (count > max) {
      return complete(format_failure(what + "at most " + std::to_string(options.max_number_bytes) +
                                     " are allowed")
                          .value(),
                      array);
    }
    if (is_too_much(count * sizeof(double), entry.packed_size, options.free_number_bytes,
                    options.max_ratio)) {
      return complete(format_failure(what + "but the file has only " +
                                         count_text(entry.packed_size, "byte") + " of them",
                                     std::string(kBombHint))
                          .value(),
                      array);
    }
    return {};
  }
};

NpzFile::NpzFile(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}

Result<NpzFile> NpzFile::open(std::string_view bytes, std::string file_name,
                              const NpzReadOptions& options) {
  auto contents = std::make_shared<Contents>();
  contents->file_name = std::move(file_name);
  contents->options = options;
  const auto fault = [&](std::string message, std::string_view hint = {}) {
    return contents->complete(format_failure(std::move(message), std::string(hint)).value());
  };

  const FileType type = file_type(bytes);
  if (!type.what.empty() && type.kind != FileKind::kNpz && type.kind != FileKind::kTorch) {
    return fault("expected an NPZ file, found " + std::string(type.what), remedy_for(type));
  }
  Result<ZipArchive> archive = ZipArchive::open(bytes);
  if (!archive) return contents->complete(archive.error());
  contents->archive = std::move(*archive);
  const std::vector<ZipEntry>& entries = contents->archive.entries();

  std::uint64_t total = 0;
  for (const ZipEntry& entry : entries) {
    // Saturate instead of overflowing.
    total += std::min(entry.size, std::numeric_limits<std::uint64_t>::max() - total);
  }
  if (is_too_much(total, bytes.size(), options.free_total_bytes, options.max_ratio)) {
    return fault("unpacked, its arrays would have " + count_text(total, "byte") +
                     ", but the file has only " + std::to_string(bytes.size()),
                 kBombHint);
  }

  std::vector<std::string> names;
  for (const ZipEntry& entry : entries) {
    std::string name = entry.name;
    if (name.ends_with(kSuffix)) name.resize(name.size() - kSuffix.size());
    if (has_control_bytes(name)) return fault("an array name contains control characters");
    if (!contents->index.emplace(name, names.size()).second) {
      return fault("there are two arrays \"" + name + "\"");
    }
    names.push_back(std::move(name));
  }
  const auto is_array = [](const ZipEntry& entry) { return entry.name.ends_with(kSuffix); };
  if (!entries.empty() && std::ranges::none_of(entries, is_array)) {
    std::vector<std::string> found;
    for (const ZipEntry& entry : entries) found.push_back(printable(entry.name));
    return fault(
        "expected an NPZ file, found a ZIP archive of other files: " + list_names(found, 8),
        type.hint);
  }
  NpzFile file(std::move(contents));
  file.names_ = std::move(names);
  return file;
}

std::optional<std::size_t> NpzFile::find(std::string_view name) const {
  const auto place = contents_->index.find(name);
  return place == contents_->index.end() ? std::nullopt : std::optional(place->second);
}

bool NpzFile::has(std::string_view name) const {
  return find(name).has_value();
}

Failure NpzFile::no_such_array(std::string_view name) const {
  const std::string found = names_.empty() ? "no arrays at all" : list_names(names_);
  return file_failure("no array \"" + std::string(name) + "\"" + did_you_mean(name, names_) +
                      "; found " + found);
}

Result<std::string> NpzFile::type_of(std::string_view name) const {
  const auto place = find(name);
  if (!place) return no_such_array(name);
  Result<ZipEntryReader> reader = contents_->archive.entry_reader(*place);
  if (!reader) return contents_->complete(reader.error(), name);
  Result<NpyHeader> header =
      read_npy_header([&reader](std::size_t size) { return reader->read(size); });
  if (!header) return contents_->complete(header.error(), name);
  return std::move(header->type);
}

Result<NpyArray> NpzFile::read(std::string_view name) const {
  const auto place = find(name);
  if (!place) return no_such_array(name);
  const ZipEntry& entry = contents_->archive.entries()[*place];
  Result<ZipEntryReader> reader = contents_->archive.entry_reader(*place);
  if (!reader) return contents_->complete(reader.error(), name);
  const Result<NpyHeader> header =
      read_npy_header([&reader](std::size_t size) { return reader->read(size); });
  if (!header) return contents_->complete(header.error(), name);
  Result<NpyLayout> layout = npy_layout(*header);
  if (!layout) return contents_->complete(layout.error(), name);

  // The size in the archive must match the size that the header implies.
  const std::string needs =
      "its shape " + shape_text(header->shape) + " of " + header->type + " needs ";
  if (entry.size < header->byte_count || entry.size - header->byte_count != layout->data_size) {
    const std::uint64_t found =
        entry.size - std::min<std::uint64_t>(entry.size, header->byte_count);
    return array_failure(
        name, needs + count_text(layout->data_size, "byte") + ", found " + std::to_string(found));
  }
  if (layout->data_size > contents_->options.max_array_bytes) {
    return array_failure(name, needs + count_text(layout->data_size, "byte") + ", at most " +
                                   std::to_string(contents_->options.max_array_bytes) +
                                   " are allowed");
  }
  if (is_too_much(entry.size, entry.packed_size, contents_->options.free_array_bytes,
                  contents_->options.max_ratio)) {
    return array_failure(name,
                         needs + count_text(layout->data_size, "byte") +
                             ", but the file has only " + count_text(entry.packed_size, "byte") +
                             " of it",
                         std::string(kBombHint));
  }
  TRY(contents_->check_numbers(name, *layout, entry));
  Result<std::string> data = reader->read(layout->data_size);
  if (!data) return contents_->complete(data.error(), name);
  const Result<void> whole = reader->finish();
  if (!whole) return contents_->complete(whole.error(), name);
  return npy_with_data(std::move(*layout), std::move(*data), header->fortran_order);
}

Failure NpzFile::array_failure(std::string_view name, const std::string& message,
                               std::string hint) const {
  return contents_->complete(format_failure(message, std::move(hint)).value(), name);
}

Failure NpzFile::file_failure(std::string message, std::string hint) const {
  return contents_->complete(format_failure(std::move(message), std::move(hint)).value());
}

namespace {

NpyArray array_of(NpyKind kind, std::size_t item_size, std::vector<std::size_t> shape) {
  NpyArray array;
  array.kind = kind;
  array.item_size = item_size;
  array.shape = std::move(shape);
  return array;
}

std::u32string characters_of(const std::string& text) {
  const std::string valid = valid_utf8(text);
  std::u32string characters;
  for (std::size_t at = 0; at < valid.size();) {
    // The text is valid, so the length is never 0; max() guarantees progress.
    const std::size_t length = std::max<std::size_t>(1, utf8_length(valid, at));
    const auto first = static_cast<unsigned char>(valid[at]);
    char32_t character = length == 1 ? first : first & (0xFFU >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) {
      character = character << 6 | (static_cast<unsigned char>(valid[at + i]) & 0x3FU);
    }
    characters += character;
    at += length;
  }
  return characters;
}

// The header of an NPY file, version 1. The array needs no data.
std::string format_npy_header(const NpyArray& array) {
  constexpr std::size_t kBeforeHeader = 10;
  constexpr std::size_t kAlignment = 64;
  std::string header = "{'descr': '" + npy_type_text(array) + "', 'fortran_order': False, " +
                       "'shape': " + shape_text(array.shape) + ", }";
  while ((kBeforeHeader + header.size() + 1) % kAlignment != 0) header += ' ';
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  append_little_endian(bytes, header.size(), 2);
  return bytes + header;
}

}  // namespace

void append_vector(std::vector<double>& values, const Eigen::Vector3d& vector) {
  values.insert(values.end(), vector.begin(), vector.end());
}

NpyArray float32_array(std::span<const double> values, std::vector<std::size_t> shape) {
  NpyArray array = array_of(NpyKind::kFloat, 4, std::move(shape));
  array.data.reserve(4 * values.size());
  for (const double value : values) {
    append_little_endian(array.data, static_cast<float>(value));
  }
  return array;
}

NpyArray float64_array(std::span<const double> values, std::vector<std::size_t> shape) {
  NpyArray array = array_of(NpyKind::kFloat, 8, std::move(shape));
  array.data.reserve(8 * values.size());
  for (const double value : values) {
    append_little_endian(array.data, std::bit_cast<std::uint64_t>(value), 8);
  }
  return array;
}

NpyArray bool_array(std::span<const std::uint8_t> values, std::vector<std::size_t> shape) {
  NpyArray array = array_of(NpyKind::kBool, 1, std::move(shape));
  for (const std::uint8_t value : values) array.data += value != 0 ? '\1' : '\0';
  return array;
}

NpyArray int64_array(std::span<const std::int64_t> values, std::vector<std::size_t> shape) {
  NpyArray array = array_of(NpyKind::kSigned, 8, std::move(shape));
  for (const std::int64_t value : values) {
    append_little_endian(array.data, std::bit_cast<std::uint64_t>(value), 8);
  }
  return array;
}

NpyArray text_array(std::span<const std::string> texts, bool scalar) {
  std::vector<std::u32string> characters;
  std::size_t longest = 1;
  for (const std::string& text : texts) {
    characters.push_back(characters_of(text));
    longest = std::max(longest, characters.back().size());
  }
  std::vector<std::size_t> shape;
  if (!scalar) shape.push_back(texts.size());
  NpyArray array = array_of(NpyKind::kText, 4 * longest, std::move(shape));
  for (std::u32string& text : characters) {
    text.resize(longest, 0);
    for (const char32_t character : text) append_little_endian(array.data, character, 4);
  }
  return array;
}

std::string npy_type_text(const NpyArray& array) {
  if (array.kind == NpyKind::kText) return "<U" + std::to_string(array.item_size / 4);
  const char letter = array.kind == NpyKind::kBool       ? 'b'
                      : array.kind == NpyKind::kSigned   ? 'i'
                      : array.kind == NpyKind::kUnsigned ? 'u'
                      : array.kind == NpyKind::kFloat    ? 'f'
                                                         : 'S';
  const bool has_order = array.item_size > 1 && letter != 'S';
  return (has_order ? "<" : "|") + std::string(1, letter) + std::to_string(array.item_size);
}

std::string format_npy(const NpyArray& array) {
  return format_npy_header(array) + array.data;
}

void NpzWriter::add(std::string_view name, const NpyArray& array) {
  zip_.add(std::string(name) + ".npy", format_npy(array));
}

Result<std::string> NpzWriter::finish() {
  return zip_.finish();
}

Result<void> NpzStream::add(std::string_view name, const NpyArray& array) {
  ZipChecksum elements;
  elements.add(array.data);
  TRY(begin(name, array, elements));
  TRY(write(array.data));
  return end();
}

Result<void> NpzStream::begin(std::string_view name, const NpyArray& array,
                              const ZipChecksum& elements) {
  const std::string header = format_npy_header(array);
  ZipChecksum content;
  content.add(header);
  content.append(elements);
  TRY(zip_.begin(std::string(name) + ".npy", content));
  return zip_.write(header);
}

}  // namespace retarget
