#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/containers/npy.h"
#include "formats/containers/zip_writer.h"
#include "retarget/error.h"

namespace retarget {

struct NpzReadOptions {
  ErrorKind error_kind = ErrorKind::kInput;  ///< Kind of all errors.
  /// Larger arrays are rejected, even well compressed ones.
  std::size_t max_array_bytes = std::size_t{1} << 30;
  /// Limit on the ratio of unpacked to packed bytes, for each compressed array and for the whole
  /// file. Recorded motions stay below 4; arrays of zeros reach 1000.
  std::size_t max_ratio = 64;
  /// Limit on the memory of an array after conversion to double.
  std::size_t max_number_bytes = std::numeric_limits<std::size_t>::max();
  /// Sizes that are always accepted: of one array as doubles, of one array as stored, and of all
  /// arrays together.
  std::size_t free_number_bytes = std::size_t{16} << 20;
  std::size_t free_array_bytes = std::size_t{32} << 20;
  std::size_t free_total_bytes = std::size_t{128} << 20;
};

/// The arrays of an NPZ file (a ZIP archive of NPY files, as numpy.savez and savez_compressed write
/// it). Each array is decoded on request.
///
/// Entries are found only through the central directory of the archive. They may be stored or
/// deflated; ZIP64 extra fields and data descriptors are supported. The checksum of every array is
/// verified. Memory for an array grows with the bytes actually unpacked, and files that unpack to
/// far more than their size (ZIP bombs) are rejected in advance. Errors name the file, the array,
/// the expected and the found value.
class NpzFile {
 public:
  /// Reads the directory. Errors: not a ZIP archive (the message names the detected type), a
  /// damaged or truncated archive, duplicate array names, arrays that are too large together.
  /// @param bytes      the whole file; must outlive the object.
  /// @param file_name  name given by the user, for messages.
  [[nodiscard]] static Result<NpzFile> open(std::string_view bytes, std::string file_name,
                                            const NpzReadOptions& options = {});

  /// Names of the arrays in directory order, without `.npy`.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has(std::string_view name) const;

  /// NumPy's type string of an array, such as `<f4`, `|S6`, or `|O` for an object array, which
  /// `read` rejects.
  [[nodiscard]] Result<std::string> type_of(std::string_view name) const;

  /// Reads an array. Errors: unknown name (the message lists the existing ones), Python objects
  /// (nothing is ever unpickled), structured, complex and long double types, encrypted entries,
  /// unsupported compression, inconsistent sizes, a wrong checksum. Memory is allocated as bytes
  /// arrive, not as the header claims.
  [[nodiscard]] Result<NpyArray> read(std::string_view name) const;

  /// An error about an array, for callers that reject its content.
  [[nodiscard]] Failure array_failure(std::string_view name, const std::string& message,
                                      std::string hint = {}) const;
  /// An error about the file as a whole.
  [[nodiscard]] Failure file_failure(std::string message, std::string hint = {}) const;

 private:
  struct Contents;
  explicit NpzFile(std::shared_ptr<const Contents> contents);
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
  [[nodiscard]] Failure no_such_array(std::string_view name) const;

  std::vector<std::string> names_;
  std::shared_ptr<const Contents> contents_;
};

/// Appends the numbers of a vector to those of an array.
void append_vector(std::vector<double>& values, const Eigen::Vector3d& vector);

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
