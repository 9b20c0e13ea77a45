#include "formats/containers/npy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace retarget {
namespace {

double half_from_bits(std::uint64_t bits) {
  constexpr int kMantissaBits = 10;
  constexpr int kBias = 15;
  const int exponent = static_cast<int>(bits >> kMantissaBits) & 31;
  const double mantissa = static_cast<double>(bits & 1023U);
  double value = 0.0;
  if (exponent == 31) {
    value = mantissa == 0.0 ? HUGE_VAL : std::nan("");
  } else if (exponent == 0) {
    value = std::ldexp(mantissa, 1 - kBias - kMantissaBits);
  } else {
    value = std::ldexp(mantissa + 1024.0, exponent - kBias - kMantissaBits);
  }
  return (bits & 0x8000U) != 0 ? -value : value;
}

double float_from_bits(std::uint64_t bits, std::size_t size) {
  if (size == 2) return half_from_bits(bits);
  if (size == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  return std::bit_cast<double>(bits);
}

double signed_from_bits(std::uint64_t bits, std::size_t size) {
  const int unused = 64 - 8 * static_cast<int>(size);
  return static_cast<double>(std::bit_cast<std::int64_t>(bits << unused) >> unused);
}

double number_from_bits(std::uint64_t bits, NpyKind kind, std::size_t size) {
  switch (kind) {
    case NpyKind::kBool:
      return bits != 0 ? 1.0 : 0.0;
    case NpyKind::kSigned:
      return signed_from_bits(bits, size);
    case NpyKind::kFloat:
      return float_from_bits(bits, size);
    default:
      return static_cast<double>(bits);
  }
}

void append_utf8(std::string& text, std::uint64_t character) {
  constexpr std::uint64_t kReplacement = 0xFFFD;
  const bool surrogate = character >= 0xD800 && character <= 0xDFFF;
  const std::uint64_t c = surrogate || character > 0x10FFFF ? kReplacement : character;
  const auto tail = [&](int shift) { text += static_cast<char>(0x80 | ((c >> shift) & 63)); };
  if (c < 0x80) {
    text += static_cast<char>(c);
  } else if (c < 0x800) {
    text += static_cast<char>(0xC0 | (c >> 6));
    tail(0);
  } else if (c < 0x10000) {
    text += static_cast<char>(0xE0 | (c >> 12));
    tail(6);
    tail(0);
  } else {
    text += static_cast<char>(0xF0 | (c >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

std::string text_from_characters(std::string_view item) {
  constexpr std::size_t kCharacter = 4;
  while (item.size() >= kCharacter &&
         little_endian(item, item.size() - kCharacter, kCharacter) == 0) {
    item.remove_suffix(kCharacter);
  }
  std::string text;
  for (std::size_t at = 0; at + kCharacter <= item.size(); at += kCharacter) {
    append_utf8(text, little_endian(item, at, kCharacter));
  }
  return text;
}

// Converts elements from Fortran order (first index fastest) to C order (last index fastest).
std::string in_c_order(const std::string& data, std::span<const std::size_t> shape,
                       std::size_t item_size) {
  std::vector<std::size_t> stride(shape.size());  // Stride of each index in the Fortran data.
  std::size_t step = item_size;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    stride[i] = step;
    step *= shape[i];
  }
  std::string ordered;
  ordered.reserve(data.size());
  std::vector<std::size_t> index(shape.size(), 0);
  std::size_t source = 0;
  while (ordered.size() < data.size()) {
    ordered.append(data, source, item_size);
    for (std::size_t i = shape.size(); i-- > 0;) {
      source += stride[i];
      if (++index[i] < shape[i]) break;
      source -= stride[i] * shape[i];
      index[i] = 0;
    }
  }
  return ordered;
}

void swap_bytes(std::string& data, std::size_t size) {
  for (auto item = data.begin(); item != data.end(); item += static_cast<std::ptrdiff_t>(size)) {
    std::reverse(item, item + static_cast<std::ptrdiff_t>(size));
  }
}

}  // namespace

std::uint64_t little_endian(std::string_view bytes, std::size_t offset, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) {
    value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
  }
  return value;
}

std::size_t NpyArray::element_count() const {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  return count;
}

std::vector<double> NpyArray::numbers() const {
  std::vector<double> values(data.size() / item_size);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = number_from_bits(little_endian(data, i * item_size, item_size), kind, item_size);
  }
  return values;
}

std::vector<std::string> NpyArray::texts() const {
  std::vector<std::string> values;
  for (std::size_t at = 0; at < data.size(); at += item_size) {
    std::string_view item = std::string_view(data).substr(at, item_size);
    if (kind == NpyKind::kText) {
      values.push_back(text_from_characters(item));
      continue;
    }
    while (item.ends_with('\0')) item.remove_suffix(1);
    values.emplace_back(item);
  }
  return values;
}

NpyArray npy_with_data(NpyLayout layout, std::string data, bool fortran_order) {
  NpyArray array = std::move(layout.array);
  constexpr std::size_t kCharacter = 4;
  const bool characters = array.kind == NpyKind::kText;
  if (layout.big_endian && array.kind != NpyKind::kBytes) {
    swap_bytes(data, characters ? kCharacter : array.item_size);
  }
  const bool reorder = fortran_order && array.shape.size() > 1;
  array.data = reorder ? in_c_order(data, array.shape, array.item_size) : std::move(data);
  return array;
}

}  // namespace retarget
