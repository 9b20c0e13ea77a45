#include "base/npz_writer.h"
#include "base/option_name.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace retarget {
namespace {

void append_number(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
}

NpyArray array_of(NpyKind kind, std::size_t item_size, std::vector<std::size_t> shape) {
  NpyArray array;
  array.kind = kind;
  array.item_size = item_size;
  array.shape = std::move(shape);
  return array;
}

// the first of January 1980, the least date that ZIP knows
constexpr std::uint64_t kNoDate = 0x00210000;
constexpr std::uint64_t kZipVersion = 20;

}  // namespace

NpyArray float32_array(std::span<const double> values, std::vector<std::size_t> shape) {
  NpyArray array = array_of(NpyKind::kFloat, 4, std::move(shape));
  array.data.reserve(4 * values.size());
  for (const double value : values) {
    append_number(array.data, std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
  }
  return array;
}

NpyArray float64_array(std::span<const double> values, std::vector<std::size_t> shape) {
  NpyArray array = array_of(NpyKind::kFloat, 8, std::move(shape));
  array.data.reserve(8 * values.size());
  for (const double value : values) {
    append_number(array.data, std::bit_cast<std::uint64_t>(value), 8);
  }
  return array;
}

NpyArray int64_array(std::span<const std::int64_t> values, std::vector<std::size_t> shape) {
  NpyArray array = array_of(NpyKind::kSigned, 8, std::move(shape));
  for (const std::int64_t value : values) {
    append_number(array.data, std::bit_cast<std::uint64_t>(value), 8);
  }
  return array;
}

NpyArray text_array(std::span<const std::string> texts, bool scalar) {
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  std::vector<std::size_t> shape;
  if (!scalar) shape.push_back(texts.size());
  NpyArray array = array_of(NpyKind::kText, 4 * longest, std::move(shape));
  for (const std::string& text : texts) {
    for (std::size_t i = 0; i < longest; ++i) {
      append_number(array.data, i < text.size() ? static_cast<unsigned char>(text[i]) : 0, 4);
    }
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
  constexpr std::size_t kBeforeHeader = 10;
  constexpr std::size_t kAlignment = 64;
  std::string header = "{'descr': '" + npy_type_text(array) + "', 'fortran_order': False, " +
                       "'shape': " + shape_text(array.shape) + ", }";
  while ((kBeforeHeader + header.size() + 1) % kAlignment != 0) header += ' ';
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  append_number(bytes, header.size(), 2);
  return bytes + header + array.data;
}

void NpzWriter::add(std::string_view name, const NpyArray& array) {
  const std::string file = std::string(name) + ".npy";
  const std::string content = format_npy(array);
  const std::uint64_t offset = bytes_.size();
  std::string entry;  // what local header and directory have in common
  append_number(entry, kZipVersion, 2);
  append_number(entry, 0, 4);  // no flags, stored
  append_number(entry, kNoDate, 4);
  append_number(entry, crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()),
                4);
  append_number(entry, content.size(), 4);
  append_number(entry, content.size(), 4);
  append_number(entry, file.size(), 2);
  append_number(entry, 0, 2);  // no extra field
  bytes_ += std::string("PK\x03\x04") + entry + file + content;
  directory_ += "PK\x01\x02";
  append_number(directory_, kZipVersion, 2);
  directory_ += entry;
  directory_ += std::string(10, '\0');  // no comment, first disk, no attributes
  append_number(directory_, offset, 4);
  directory_ += file;
  ++count_;
}

Result<std::string> NpzWriter::finish() {
  constexpr std::uint64_t kMaxZipBytes = 0xFFFFFFFF;
  if (bytes_.size() + directory_.size() >= kMaxZipBytes) {
    return run_failure("", "the motion is too long for one NPZ file, which holds up to 4 GiB",
                       "write it in parts, with " OPTION("start") " and " OPTION("end"));
  }
  std::string end = "PK\x05\x06";
  append_number(end, 0, 4);
  append_number(end, count_, 2);
  append_number(end, count_, 2);
  append_number(end, directory_.size(), 4);
  append_number(end, bytes_.size(), 4);
  append_number(end, 0, 2);
  return std::move(bytes_) + directory_ + end;
}

}  // namespace retarget
