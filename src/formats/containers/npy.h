#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace retarget {

/// Element type of a NumPy array.
enum class NpyKind : std::uint8_t {
  kBool,      ///< b1: one byte, 0 is false.
  kSigned,    ///< i1, i2, i4, i8.
  kUnsigned,  ///< u1, u2, u4, u8.
  kFloat,     ///< f2, f4, f8 (IEEE 754).
  kBytes,     ///< S: a fixed number of bytes, padded with zeros.
  kText,      ///< U: a fixed number of UCS-4 characters, padded with zeros.
};

/// A NumPy array in memory, independent of how a file stores it.
struct NpyArray {
  NpyKind kind = NpyKind::kFloat;
  std::size_t item_size = 8;       ///< Bytes per element; for kText, 4 per character.
  std::vector<std::size_t> shape;  ///< Empty: a scalar (0-d).
  std::string data;                ///< The elements in C order, each little endian.

  /// Product of the shape; 1 for a scalar.
  [[nodiscard]] std::size_t element_count() const;
  [[nodiscard]] bool is_number() const { return kind <= NpyKind::kFloat; }
  [[nodiscard]] bool is_text() const { return !is_number(); }

  /// All elements in C order. Integers beyond 2^53 are rounded.
  /// @pre is_number()
  [[nodiscard]] std::vector<double> numbers() const;

  /// All elements in C order without their trailing zeros. kText is converted to UTF-8, with U+FFFD
  /// for invalid characters; kBytes is returned unchanged.
  /// @pre is_text()
  [[nodiscard]] std::vector<std::string> texts() const;
};

/// The shape as Python prints it: `()`, `(3,)`, `(152, 72)`.
[[nodiscard]] std::string shape_text(std::span<const std::size_t> shape);

}  // namespace retarget
