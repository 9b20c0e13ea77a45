#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "retarget/export.h"

namespace RETARGET_API retarget {

/// Reads numbers and strings from a packet in a fixed byte order. Reads beyond the end return zero
/// or an empty string and clear `ok` for good, so one check after several reads is enough.
template <std::endian kOrder>
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  /// Whether all reads so far stayed within the packet.
  [[nodiscard]] bool ok() const { return ok_; }
  /// Number of unread bytes.
  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  /// Whether `count` items of `item_size` bytes can still follow. Check a count from the packet
  /// with it before use.
  [[nodiscard]] bool may_hold(std::size_t count, std::size_t item_size) const {
    return ok_ && count <= rest_.size() / item_size;
  }

  std::string_view bytes(std::size_t size) {
    if (size > rest_.size()) return fail();
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  /// A string that ends with a zero byte.
  std::string_view text() {
    const std::size_t size = rest_.find('\0');
    if (size == std::string_view::npos) return fail();
    return bytes(size + 1).substr(0, size);
  }
  /// An integer or an IEEE 754 number of sizeof(Number) bytes.
  template <typename Number>
  Number number() {
    using Bits = std::conditional_t<
        sizeof(Number) == 8, std::uint64_t,
        std::conditional_t<sizeof(Number) == 4, std::uint32_t,
                           std::conditional_t<sizeof(Number) == 2, std::uint16_t, std::uint8_t>>>;
    const std::string_view taken = bytes(sizeof(Number));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const std::size_t from = kOrder == std::endian::big ? i : taken.size() - 1 - i;
      value = value << 8U | static_cast<unsigned char>(taken[from]);
    }
    return std::bit_cast<Number>(static_cast<Bits>(value));
  }

 private:
  std::string_view fail() {
    ok_ = false;
    rest_ = {};
    return {};
  }

  std::string_view rest_;
  bool ok_ = true;
};

/// Appends the `size` least significant bytes of a number in big-endian order.
inline void append_big_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int i = size; i-- > 0;) bytes += static_cast<char>(value >> (8 * i));
}
inline void append_big_endian(std::string& bytes, float value) {
  append_big_endian(bytes, std::bit_cast<std::uint32_t>(value), 4);
}

/// Appends the `size` least significant bytes of a number in little-endian order.
inline void append_little_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
}
inline void append_little_endian(std::string& bytes, float value) {
  append_little_endian(bytes, std::bit_cast<std::uint32_t>(value), 4);
}

/// Encodes bytes as Base64, alphabet `A-Za-z0-9+/`, padded with `=` (RFC 4648).
[[nodiscard]] std::string base64_text(std::string_view bytes);

/// Decodes Base64 text, with or without padding. Returns nothing for invalid text.
[[nodiscard]] std::optional<std::string> bytes_from_base64(std::string_view text);

}  // namespace retarget
