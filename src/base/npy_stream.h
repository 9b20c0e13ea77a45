#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/npy.h"
#include "retarget/error.h"

namespace retarget {

/// Gives the next `size` bytes of an NPY file, or an error when there are fewer. Takes no memory
/// for bytes that do not come.
using ReadBytes = std::function<Result<std::string>(std::size_t size)>;

/// What stands before the elements of an NPY file.
struct NpyHeader {
  std::string type;  ///< NumPy's text for it, such as `<f4`; `[...` for structured types.
  bool fortran_order = false;
  std::vector<std::size_t> shape;
  std::size_t byte_count = 0;  ///< Of the header itself, all that comes before the elements.
};

/// Reads the header, versions 1 to 3. Errors of the functions here have a message and a hint only.
[[nodiscard]] Result<NpyHeader> read_npy_header(const ReadBytes& read);

/// The array of a header, still without elements.
struct NpyLayout {
  NpyArray array;
  std::size_t data_size = 0;  ///< Bytes of all elements.
  bool big_endian = false;
};

/// What a header means; refuses types that cannot be read and shapes beyond all memory.
[[nodiscard]] Result<NpyLayout> npy_layout(const NpyHeader& header);

/// The array with its elements, given as the file stores them.
/// @pre data.size() == layout.data_size
[[nodiscard]] NpyArray npy_with_data(NpyLayout layout, std::string data, bool fortran_order);

/// An error without a file.
[[nodiscard]] Failure format_failure(std::string message, std::string hint = {});

/// The unsigned number in `size` <= 8 bytes, the least significant one first.
/// @pre offset + size <= bytes.size()
[[nodiscard]] std::uint64_t little_endian(std::string_view bytes, std::size_t offset,
                                          std::size_t size);

}  // namespace retarget
