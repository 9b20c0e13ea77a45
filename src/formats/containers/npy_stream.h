#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/npy.h"
#include "retarget/error.h"

namespace retarget {

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
