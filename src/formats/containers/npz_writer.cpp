#include "formats/containers/npz_writer.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/try.h"
#include "retarget/bytes.h"
#include "retarget/text.h"

namespace retarget {
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

}  // namespace

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
