#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/npy.h"
#include "retarget/error.h"

namespace retarget {

/// A value of a Python pickle. Nodes are stored in their document and refer to each other by index,
/// so deep or circular structures need no recursion.
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
    kTensor,  ///< A PyTorch tensor; its numbers are stored outside the pickle.
    kObject,  ///< An intermediate object, such as a class or a dtype, that did not become an array.
  };
  Kind kind = Kind::kNone;
  /// `detail` of a list: a NumPy array of Python objects with several dimensions.
  static constexpr std::uint8_t kObjectTable = 1;
  std::uint8_t detail = 0;   ///< Otherwise internal to the reader.
  std::int64_t integer = 0;  ///< Value of kBool and kInteger; array or tensor index.
  double number = 0.0;
  std::string_view text;             ///< Value of kText (unvalidated UTF-8) and kBytes.
  std::vector<std::uint32_t> items;  ///< Elements; of kDict: key, value, key, value, ...
};

/// A tensor in a PyTorch file: a strided view of one of the file's storages. All sizes count
/// elements.
struct PickleTensor {
  std::string_view storage;         ///< The storage's key.
  std::string_view type;            ///< NumPy type without byte order: `f4`; `bf16`: bfloat16.
  std::uint64_t storage_count = 0;  ///< Size of the whole storage, as the pickle claims.
  std::uint64_t offset = 0;
  std::vector<std::size_t> shape;
  std::vector<std::size_t> strides;  ///< One per dimension.
};

/// The content of a pickle.
class PickleDocument {
 public:
  [[nodiscard]] const PickleNode& root() const { return nodes_[root_]; }
  [[nodiscard]] const PickleNode& at(std::uint32_t node) const { return nodes_[node]; }
  /// Looks up a dictionary member by its text key; of duplicates the last one wins. Null if the
  /// key is missing or `dictionary` is not a dictionary.
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
  /// A number, or the only element of an array. Returns nothing for other nodes.
  [[nodiscard]] std::optional<double> number(const PickleNode& node) const;

 private:
  friend class PickleReader;
  friend Result<PickleDocument> read_pickle(std::string_view bytes, const std::string& file);
  friend Result<PickleDocument> read_torch_pickle(std::string bytes, const std::string& file);
  std::string unpacked_;  // Unpacked bytes of a compressed file.
  std::deque<PickleNode> nodes_;
  std::deque<NpyArray> arrays_;
  std::deque<PickleTensor> tensors_;
  std::deque<std::string> texts_;  // Strings that do not occur literally in the file.
  std::uint32_t root_ = 0;
};

/// Quick check whether bytes are a pickle, also of protocol 0 or 1 (which are not supported), or
/// start like one that joblib compressed with zlib or gzip.
[[nodiscard]] bool looks_like_pickle(std::string_view bytes);

/// Reads a pickle of plain values and NumPy arrays. Nothing in it is ever executed.
///
/// Supported are the opcodes of protocols 2 to 5 that such values need. A pickle may name only
/// these functions and classes: NumPy's constructors of array, dtype and scalar (`numpy.core` and
/// `numpy._core`), `_codecs.encode`, `collections.OrderedDict`, and joblib's `NumpyArrayWrapper`
/// with the raw array bytes that follow it (padded since joblib 1.2). joblib files may be
/// compressed with zlib or gzip. Anything else (other opcodes, other names, truncation) is an error
/// that names it and its byte offset. Memory is allocated for bytes that are present, not for sizes
/// that the file claims: at most one value per four bytes of the file (or two million, if that is
/// more), arrays together no larger than the file, and a compressed file unpacks to at most 1 GiB
/// and to at most 64 times its size (or 8 MiB, if that is more).
///
/// @param bytes  the whole file; must outlive the document.
/// @param file   name for messages.
[[nodiscard]] Result<PickleDocument> read_pickle(std::string_view bytes, const std::string& file);

/// Whether bytes are a pickle that read_pickle() cannot read because it is cut off or damaged, or
/// because it is too large when unpacked. Then its content is unknown.
[[nodiscard]] bool is_damaged_pickle(std::string_view bytes);

/// Reads the pickle in a PyTorch archive (base/torch_file.h); see read_pickle. In addition, it may
/// name the constructors of tensors, the storage types, `torch.Size`, `torch.device` and
/// ProtoMotions' string enum. Persistent ids must refer to a storage. A tensor has only its layout,
/// which is checked to lie within the storage size that the pickle claims. States of dictionaries,
/// as in network weights, are ignored.
/// @param bytes  moved into the document.
[[nodiscard]] Result<PickleDocument> read_torch_pickle(std::string bytes, const std::string& file);

/// Writes a Python pickle of protocol 4, opcode by opcode: plain values, and NumPy arrays in the
/// form that NumPy itself pickles (`numpy.core.multiarray._reconstruct`, which NumPy 1 and 2 both
/// accept). Values are never shared, so no memo is needed.
class PickleWriter {
 public:
  PickleWriter();

  void begin_dict();
  void end_dict();
  void begin_list();
  void end_list();
  void none();
  void integer(std::int64_t value);
  void number(double value);
  /// Replaces invalid UTF-8, which Python would reject.
  void text(std::string_view value);
  void texts(std::span<const std::string> values);  ///< A list.
  void array(const NpyArray& array);
  /// Adds an array to the current dictionary.
  void array(std::string_view key, const NpyArray& value) {
    text(key);
    array(value);
  }

  /// Returns the whole pickle.
  [[nodiscard]] std::string finish();

 private:
  void bytes(std::string_view value);
  void tuple_of_lengths(std::span<const std::size_t> lengths);
  void global(std::string_view module, std::string_view name);

  std::string bytes_;
};

}  // namespace retarget
