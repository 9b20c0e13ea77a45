#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/containers/npy.h"
#include "formats/containers/zip_writer.h"
#include "retarget/error.h"

namespace retarget {

/// NumPy arrays in row-major (C) order. @pre values.size() is the product of the shape
[[nodiscard]] NpyArray float32_array(std::span<const double> values,
                                     std::vector<std::size_t> shape);
[[nodiscard]] NpyArray float64_array(std::span<const double> values,
                                     std::vector<std::size_t> shape);
[[nodiscard]] NpyArray int64_array(std::span<const std::int64_t> values,
                                   std::vector<std::size_t> shape);
[[nodiscard]] NpyArray bool_array(std::span<const std::uint8_t> values,
                                  std::vector<std::size_t> shape);
/// UTF-8 strings as NumPy's type U: a 1-D array, or a 0-d array when `scalar` is set. @pre one text
/// for a scalar
[[nodiscard]] NpyArray text_array(std::span<const std::string> texts, bool scalar = false);

/// NumPy's string for the element type of an array: `<f4`, `|b1`.
[[nodiscard]] std::string npy_type_text(const NpyArray& array);

/// The header of an NPY file, version 1. The array needs no data.
[[nodiscard]] std::string format_npy_header(const NpyArray& array);

/// The bytes of an NPY file, version 1.
[[nodiscard]] std::string format_npy(const NpyArray& array);

/// Builds an NPZ file as numpy.savez does: a ZIP archive of uncompressed NPY files. Entries have no
/// date, so equal arrays give equal bytes.
class NpzWriter {
 public:
  void add(std::string_view name, const NpyArray& array);
  /// The whole file. Errors (kRun): 4 GiB or more, which plain ZIP archives cannot hold.
  [[nodiscard]] Result<std::string> finish();

 private:
  ZipWriter zip_;
};

/// Writes the same NPZ file as NpzWriter as a stream, so its size is not limited by memory.
class NpzStream {
 public:
  explicit NpzStream(WriteBytes write) : zip_(std::move(write)) {}

  [[nodiscard]] Result<void> add(std::string_view name, const NpyArray& array);
  /// Begins an array whose elements are written next.
  /// @param array     the array without its elements.
  /// @param elements  checksum and size of the elements that follow.
  [[nodiscard]] Result<void> begin(std::string_view name, const NpyArray& array,
                                   const ZipChecksum& elements);
  /// Writes the next elements, encoded as in NpyArray::data.
  [[nodiscard]] Result<void> write(std::string_view elements) { return zip_.write(elements); }
  /// Ends the array. Errors (kRun): the elements do not match the checksum given to `begin`.
  [[nodiscard]] Result<void> end() { return zip_.end(); }
  /// Ends the file.
  [[nodiscard]] Result<void> finish() { return zip_.finish(); }

 private:
  ZipStream zip_;
};

}  // namespace retarget
