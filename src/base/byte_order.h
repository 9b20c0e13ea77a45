#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace retarget {

/// Numbers and texts of a packet, one after the other, in one order of bytes. What is not there reads
/// as zero or empty, and `ok` says so from then on: one question behind several reads is enough.
template <std::endian kOrder>
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  /// Whether all that was asked for was there.
  [[nodiscard]] bool ok() const { return ok_; }
  /// Bytes that are not read yet.
  [[nodiscard]] std::size_t left() const { return rest_.size(); }
  /// Whether so many items of a size may follow: a count of a packet is not believed before.
  [[nodiscard]] bool may_hold(std::size_t count, std::size_t item_size) const {
    return ok_ && count <= rest_.size() / item_size;
  }

  std::string_view bytes(std::size_t size) {
    if (size > rest_.size()) return fail();
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  /// A text that a zero byte ends.
  std::string_view text() {
    const std::size_t size = rest_.find('\0');
    if (size == std::string_view::npos) return fail();
    return bytes(size + 1).substr(0, size);
  }
  /// An integer or a number of IEEE 754, as many bytes as the type has.
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

/// Appends the `size` least significant bytes of a number, the most significant one of them first.
inline void append_big_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int i = size; i-- > 0;) bytes += static_cast<char>(value >> (8 * i));
}
inline void append_big_endian(std::string& bytes, float value) {
  append_big_endian(bytes, std::bit_cast<std::uint32_t>(value), 4);
}

/// The same, the least significant byte first.
inline void append_little_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
}
inline void append_little_endian(std::string& bytes, float value) {
  append_little_endian(bytes, std::bit_cast<std::uint32_t>(value), 4);
}

}  // namespace retarget
