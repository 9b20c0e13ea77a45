#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "formats/containers/npy.h"
#include "retarget/text.h"

namespace retarget {

/// Reads an NPY file with the functions that read archive members. Rejects a shape that contradicts
/// the number of bytes.
/// @param file_name  file name for error messages
inline Result<NpyArray> read_npy(std::string_view bytes, const std::string& file_name) {
  const auto fault = [&](Error error) {
    error.kind = ErrorKind::kInput;
    error.location.file = file_name;
    return failure(std::move(error));
  };
  std::string_view rest = bytes;
  const ReadBytes read = [&rest](std::size_t size) -> Result<std::string> {
    if (size > rest.size()) {
      return format_failure("the file is truncated: expected " + count_text(size, "byte") +
                            ", found " + std::to_string(rest.size()));
    }
    std::string part(rest.substr(0, size));
    rest.remove_prefix(size);
    return part;
  };
  const Result<NpyHeader> header = read_npy_header(read);
  if (!header) return fault(header.error());
  Result<NpyLayout> layout = npy_layout(*header);
  if (!layout) return fault(layout.error());
  if (rest.size() != layout->data_size) {
    Error error;
    error.message = "its shape " + shape_text(header->shape) + " of " + header->type + " needs " +
                    count_text(layout->data_size, "byte") + ", found " +
                    std::to_string(rest.size());
    return fault(std::move(error));
  }
  return npy_with_data(std::move(*layout), std::string(rest), header->fortran_order);
}

}  // namespace retarget
