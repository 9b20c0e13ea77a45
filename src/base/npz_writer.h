#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/npy.h"
#include "base/zip_writer.h"
#include "retarget/error.h"

namespace retarget {

/// Arrays as NumPy holds them, row by row. @pre values.size() is the product of the shape
[[nodiscard]] NpyArray float32_array(std::span<const double> values,
                                     std::vector<std::size_t> shape);
[[nodiscard]] NpyArray float64_array(std::span<const double> values,
                                     std::vector<std::size_t> shape);
[[nodiscard]] NpyArray int64_array(std::span<const std::int64_t> values,
                                   std::vector<std::size_t> shape);
[[nodiscard]] NpyArray bool_array(std::span<const std::uint8_t> values,
                                  std::vector<std::size_t> shape);
/// UTF-8 texts as NumPy's type U; without a shape of their own a list, `scalar` for one alone.
[[nodiscard]] NpyArray text_array(std::span<const std::string> texts, bool scalar = false);

/// NumPy's text for the type of an array's elements: `<f4`, `|b1`.
[[nodiscard]] std::string npy_type_text(const NpyArray& array);

/// What stands before the elements in an NPY file, version 1. The array needs no data.
[[nodiscard]] std::string format_npy_header(const NpyArray& array);

/// The bytes of an NPY file, version 1.
[[nodiscard]] std::string format_npy(const NpyArray& array);

/// Builds an NPZ file as numpy.savez does: a ZIP archive of NPY files, not compressed. Entries
/// have no date, so that the same arrays give the same bytes.
class NpzWriter {
 public:
  void add(std::string_view name, const NpyArray& array);
  /// The whole file. Errors (kRun): 4 GiB or more, which plain ZIP archives cannot hold.
  [[nodiscard]] Result<std::string> finish();

 private:
  ZipWriter zip_;
};

/// An NPZ file as of NpzWriter that goes out as it comes, however large.
class NpzStream {
 public:
  explicit NpzStream(WriteBytes write) : zip_(std::move(write)) {}

  [[nodiscard]] Result<void> add(std::string_view name, const NpyArray& array);
  /// Begins an array whose elements follow.
  /// @param array     all but its elements.
  /// @param elements  what they will be.
  [[nodiscard]] Result<void> begin(std::string_view name, const NpyArray& array,
                                   const ZipChecksum& elements);
  /// The next elements, as NpyArray::data has them.
  [[nodiscard]] Result<void> write(std::string_view elements) { return zip_.write(elements); }
  /// Ends it. Errors (kRun): the elements are not what `begin` was told.
  [[nodiscard]] Result<void> end() { return zip_.end(); }
  /// Ends the file.
  [[nodiscard]] Result<void> finish() { return zip_.finish(); }

 private:
  ZipStream zip_;
};

}  // namespace retarget
