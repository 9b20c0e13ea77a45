#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/npy.h"
#include "retarget/error.h"

namespace retarget {

struct NpzReadOptions {
  ErrorKind error_kind = ErrorKind::kInput;  ///< Of every error.
  /// A larger array is refused, however well compressed it is.
  std::size_t max_array_bytes = std::size_t{1} << 30;
  /// Compressed arrays may unpack to so many times the bytes that they have in the file, and all of
  /// them together to so many times the file. Measured motions are below 4; noughts alone reach 1000.
  std::size_t max_ratio = 64;
  /// Of the numbers of an array as doubles, which they become: more are refused.
  std::size_t max_number_bytes = std::numeric_limits<std::size_t>::max();
  /// What is let pass in any case: of one array, as doubles and as it is, and of all together.
  std::size_t free_number_bytes = std::size_t{16} << 20;
  std::size_t free_array_bytes = std::size_t{32} << 20;
  std::size_t free_total_bytes = std::size_t{128} << 20;
};

/// The arrays of an NPZ file (a ZIP archive of NPY files, as numpy.savez and savez_compressed
/// write it), each decoded when it is asked for.
///
/// Entries are found through the archive's central directory alone, stored or deflated, with ZIP64
/// extras and data descriptors; every array that is read is held against its checksum. Memory for
/// an array grows with the bytes that are really there, and files that unpack to much more than they
/// are, as bombs do, are refused before any is taken. Errors name the file, the array, what was
/// expected and what was found.
class NpzFile {
 public:
  /// Reads the directory. Errors: no ZIP archive (and what it is instead), a damaged or cut off
  /// one, several arrays of one name, arrays that are too large together.
  /// @param bytes      the whole file; must outlive the object.
  /// @param file_name  as the user named it, for messages.
  [[nodiscard]] static Result<NpzFile> open(std::string_view bytes, std::string file_name,
                                            const NpzReadOptions& options = {});

  /// The arrays' names in the order of the directory, without `.npy`.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has(std::string_view name) const;

  /// NumPy's text for an array's type, such as `<f4`, `|S6`, or `|O` for what `read` refuses.
  [[nodiscard]] Result<std::string> type_of(std::string_view name) const;

  /// An array. Errors: no such array (with the names that there are), Python objects (nothing is
  /// ever unpickled), structured, complex and long double types, encrypted or otherwise compressed
  /// entries, sizes that disagree, a wrong checksum. Memory follows the bytes, not the header.
  [[nodiscard]] Result<NpyArray> read(std::string_view name) const;

  /// An error about an array, for those who find fault with its content.
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

}  // namespace retarget
