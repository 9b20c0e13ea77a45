#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "retarget/error.h"

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

/// Returns the next `size` bytes of an NPY file, or an error when fewer are left. Must not allocate
/// memory for bytes that do not arrive.
using ReadBytes = std::function<Result<std::string>(std::size_t size)>;

/// The header of an NPY file.
struct NpyHeader {
  std::string type;  ///< NumPy's type string, such as `<f4`; `[...` for structured types.
  bool fortran_order = false;
  std::vector<std::size_t> shape;
  std::size_t byte_count = 0;  ///< Size of the header itself, up to the first element.
};

/// Reads a header of version 1 to 3. Errors of the functions in this file have only a message and a
/// hint.
[[nodiscard]] Result<NpyHeader> read_npy_header(const ReadBytes& read);

/// An array that matches a header, without elements.
struct NpyLayout {
  NpyArray array;
  std::size_t data_size = 0;  ///< Bytes of all elements.
  bool big_endian = false;
};

/// Interprets a header. Refuses unsupported types and shapes whose size overflows.
[[nodiscard]] Result<NpyLayout> npy_layout(const NpyHeader& header);

/// The array with its elements, given in the byte order and layout of the file.
/// @pre data.size() == layout.data_size
[[nodiscard]] NpyArray npy_with_data(NpyLayout layout, std::string data, bool fortran_order);

/// Reads the header of an NPY file in memory and removes it from `bytes`.
[[nodiscard]] Result<NpyHeader> take_npy_header(std::string_view& bytes);

/// Reads the array that fills the rest of an NPY file.
/// @param max_number_bytes  limit on the memory of the array after conversion to double.
[[nodiscard]] Result<NpyArray> read_npy_rest(const NpyHeader& header, std::string_view bytes,
                                             std::size_t max_number_bytes);

/// An error without a file name.
[[nodiscard]] Failure format_failure(std::string message, std::string hint = {});

/// Decodes an unsigned little-endian number of `size` <= 8 bytes.
/// @pre offset + size <= bytes.size()
[[nodiscard]] std::uint64_t little_endian(std::string_view bytes, std::size_t offset,
                                          std::size_t size);

}  // namespace retarget
