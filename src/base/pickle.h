#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/npy.h"
#include "retarget/error.h"

namespace retarget {

/// A value of a Python pickle. Values live in their document and name each other by index, so
/// neither depth nor circles need recursion.
struct PickleNode {
  enum class Kind : std::uint8_t {
    kNone,
    kBool,
    kInteger,
    kNumber,
    kText,
    kBytes,
    kList,
    kTuple,
    kDict,
    kArray,   ///< A NumPy array; NumPy scalars are arrays without dimensions.
    kTensor,  ///< An array of PyTorch's, whose numbers are not in the pickle.
    kObject,  ///< A part of an array that no array came of.
  };
  Kind kind = Kind::kNone;
  std::uint8_t detail = 0;   ///< For the reader itself.
  std::int64_t integer = 0;  ///< Of kBool, kInteger; of kArray, kTensor its number in the document.
  double number = 0.0;
  std::string_view text;             ///< Of kText (UTF-8 as it came) and kBytes.
  std::vector<std::uint32_t> items;  ///< Of kDict: key, value, key, value, ...
};

/// An array in a file of PyTorch: a view of one of the file's storages, all in elements.
struct PickleTensor {
  std::string_view storage;  ///< The storage's key.
  std::string_view type;     ///< NumPy's text for it, `f4`, without byte order; `bf16`: bfloat16.
  std::uint64_t storage_count = 0;  ///< Of the whole storage, as the pickle claims.
  std::uint64_t offset = 0;
  std::vector<std::size_t> shape;
  std::vector<std::size_t> strides;  ///< One for each size of the shape.
};

/// What a pickle holds.
class PickleDocument {
 public:
  [[nodiscard]] const PickleNode& root() const { return nodes_[root_]; }
  [[nodiscard]] const PickleNode& at(std::uint32_t node) const { return nodes_[node]; }
  /// A member of a dictionary by its text key, the last of several; null where there is none or
  /// `dictionary` is something else.
  [[nodiscard]] const PickleNode* find(const PickleNode& dictionary, std::string_view key) const;
  /// The text keys of a dictionary, in order.
  [[nodiscard]] std::vector<std::string> keys(const PickleNode& dictionary) const;
  /// @pre node.kind is kArray
  [[nodiscard]] const NpyArray& array(const PickleNode& node) const {
    return arrays_[static_cast<std::size_t>(node.integer)];
  }
  /// @pre node.kind is kTensor
  [[nodiscard]] const PickleTensor& tensor(const PickleNode& node) const {
    return tensors_[static_cast<std::size_t>(node.integer)];
  }
  /// A number, or an array's only one.
  [[nodiscard]] std::optional<double> number(const PickleNode& node) const;

 private:
  friend class PickleReader;
  friend Result<PickleDocument> read_pickle(std::string_view bytes, const std::string& file);
  friend Result<PickleDocument> read_torch_pickle(std::string bytes, const std::string& file);
  std::string unpacked_;  // the bytes of a compressed file
  std::deque<PickleNode> nodes_;
  std::deque<NpyArray> arrays_;
  std::deque<PickleTensor> tensors_;
  std::deque<std::string> texts_;  // those that are not in the file as they are
  std::uint32_t root_ = 0;
};

/// Whether bytes are a pickle as far as they tell at a glance (also of protocols 0 and 1, which are
/// not read), or begin as one that joblib compressed with zlib or gzip.
[[nodiscard]] bool looks_like_pickle(std::string_view bytes);

/// Reads a pickle of plain values and NumPy arrays; nothing in it is ever executed.
///
/// Taken are the opcodes of protocols 2 to 5 that such values need, and of the functions and
/// classes that a pickle may name: NumPy's array, dtype and scalar makers (`numpy.core` and
/// `numpy._core`), `_codecs.encode`, `collections.OrderedDict`, and joblib's
/// `NumpyArrayWrapper` with the raw array bytes that follow it (padded since joblib 1.2), in files
/// of joblib also compressed by zlib or gzip. Everything else is an error that names it and the
/// byte where it stands: other opcodes, other names, what is cut off. Memory follows the bytes that
/// are there and not what they claim: at most two million values, arrays together no larger than
/// the file, a compressed file at most 1 GiB unpacked and not beyond 64 times its size (or 32 MiB).
///
/// @param bytes  the whole file; must outlive the document.
/// @param file   for messages.
[[nodiscard]] Result<PickleDocument> read_pickle(std::string_view bytes, const std::string& file);

/// The same for the pickle in an archive of PyTorch (base/torch_file.h), which may also name the
/// makers of tensors, the types of storages, `torch.Size`, `torch.device` and ProtoMotions' enum of
/// words; references out of the file name a storage. A tensor has its layout only, checked to lie in
/// the storage that the pickle claims. States given to dictionaries, as of networks, are left out.
/// @param bytes  the document keeps them.
[[nodiscard]] Result<PickleDocument> read_torch_pickle(std::string bytes, const std::string& file);

}  // namespace retarget
