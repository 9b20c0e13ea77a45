#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/npy.h"
#include "formats/containers/pickle.h"
#include "retarget/error.h"

namespace retarget {

struct TorchReadOptions {
  /// Limit on the memory of a tensor after conversion to double.
  std::size_t max_number_bytes = std::numeric_limits<std::size_t>::max();
  /// Limit on the ratio of a tensor's bytes to those of its storage, which a view with repeated
  /// elements can exceed.
  std::size_t max_ratio = 64;
  /// Size that is always accepted, of a tensor and of an unpacked entry.
  std::size_t free_bytes = std::size_t{8} << 20;
};

/// A file written by torch.save: a ZIP archive with a pickle, `NAME/data.pkl`, and the raw numbers
/// of the tensors' storages, `NAME/data/KEY`. Nothing in it is ever executed; see
/// read_torch_pickle.
///
/// Tensors are decoded on request, so rejecting an unrelated file costs no more than reading its
/// pickle. Memory is allocated for bytes that are present, not for sizes that the pickle or the
/// directory claims.
class TorchFile {
 public:
  /// Reads the pickle. Errors: not a ZIP archive, a damaged or truncated archive, a TorchScript
  /// program, and the errors of read_torch_pickle.
  /// @param bytes      the whole file; must outlive the object.
  /// @param file_name  name given by the user, for messages.
  [[nodiscard]] static Result<TorchFile> open(std::string_view bytes, std::string file_name,
                                              const TorchReadOptions& options = {});

  [[nodiscard]] const PickleDocument& document() const;

  /// Reads the numbers of a tensor; bfloat16 becomes float32. Errors: the storage is missing,
  /// damaged or has another size than the pickle claims; too many numbers.
  /// @param what  name of the tensor for messages.
  /// @pre node is of kind kTensor and belongs to document()
  [[nodiscard]] Result<NpyArray> read(const PickleNode& node, std::string_view what) const;

 private:
  struct Contents;
  explicit TorchFile(std::shared_ptr<const Contents> contents);
  std::shared_ptr<const Contents> contents_;
};

/// Whether bytes are an archive written by torch.save; also true for a truncated one.
[[nodiscard]] bool is_torch_file(std::string_view bytes);

/// Whether bytes were written by torch.save before PyTorch 1.6, as a sequence of pickles without an
/// archive. This format is not supported.
[[nodiscard]] bool is_old_torch_file(std::string_view bytes);

/// Writes a dictionary as torch.save does since PyTorch 1.6: a ZIP archive with a pickle of
/// protocol 2 and one storage per tensor. Entries have no date and storages are not compressed, so
/// equal values give equal bytes.
class TorchWriter {
 public:
  TorchWriter();

  void integer(std::string_view key, std::int64_t value);
  void number(std::string_view key, double value);
  /// A tensor of type f4, f8, i8 or b1.
  void tensor(std::string_view key, const NpyArray& array);
  /// A member of a Python enum, by its value.
  void enum_member(std::string_view key, std::string_view module, std::string_view name,
                   std::string_view value);

  /// Returns the whole file.
  /// @param folder  top-level folder of the archive; plain ASCII.
  [[nodiscard]] Result<std::string> finish(std::string_view folder);

 private:
  void text(std::string_view value);
  void tuple_of(const std::vector<std::size_t>& sizes);
  void global(std::string_view module, std::string_view name);

  std::string pickle_;
  std::vector<std::string> storages_;
};

}  // namespace retarget
