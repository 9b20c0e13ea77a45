#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "formats/containers/npy.h"
#include "formats/containers/pickle.h"
#include "retarget/error.h"

namespace retarget {

/// The supported opcodes of Python's pickle format (protocols 2 to 5; cpython's
/// Lib/pickletools.py).
enum class PickleOp : std::uint8_t {
  kMark = '(',
  kStop = '.',
  kBinFloat = 'G',
  kBinInt = 'J',
  kBinInt1 = 'K',
  kBinInt2 = 'M',
  kNone = 'N',
  kBinPersId = 'Q',  // Only in PyTorch files.
  kReduce = 'R',
  kBinString = 'T',
  kShortBinString = 'U',
  kBinUnicode = 'X',
  kAppend = 'a',
  kBuild = 'b',
  kGlobal = 'c',
  kDict = 'd',
  kAppends = 'e',
  kBinGet = 'h',
  kLongBinGet = 'j',
  kList = 'l',
  kBinPut = 'q',
  kLongBinPut = 'r',
  kSetItem = 's',
  kTuple = 't',
  kSetItems = 'u',
  kEmptyTuple = ')',
  kEmptyList = ']',
  kEmptyDict = '}',
  kBinBytes = 'B',
  kShortBinBytes = 'C',
  kProto = 0x80,
  kNewObj = 0x81,
  kTuple1 = 0x85,
  kTuple2 = 0x86,
  kTuple3 = 0x87,
  kNewTrue = 0x88,
  kNewFalse = 0x89,
  kLong1 = 0x8a,
  kShortBinUnicode = 0x8c,
  kBinUnicode8 = 0x8d,
  kBinBytes8 = 0x8e,
  kStackGlobal = 0x93,
  kMemoize = 0x94,
  kFrame = 0x95,
  kByteArray8 = 0x96,
};

inline void append_opcode(std::string& bytes, PickleOp op) {
  bytes += static_cast<char>(op);
}

void append_integer(std::string& bytes, std::int64_t value);
void append_number(std::string& bytes, double value);

/// Interprets the opcodes of a pickle and builds its document; see read_pickle.
class PickleReader {
 public:
  /// Objects that a pickle may contain in addition to plain values and NumPy arrays.
  enum class Dialect : std::uint8_t { kPlain, kTorch };

  /// @param file_bytes  size of the file, which is smaller than `bytes` if it is compressed. It
  ///     limits the number of values.
  PickleReader(std::string_view bytes, std::string file, PickleDocument& document,
               Dialect dialect = Dialect::kPlain, std::size_t file_bytes = 0)
      : bytes_(bytes),
        file_(std::move(file)),
        document_(document),
        dialect_(dialect),
        max_nodes_(node_limit(file_bytes)) {}

  [[nodiscard]] Result<void> read();
  /// Whether read() found the pickle damaged, rather than something in it that it refuses.
  [[nodiscard]] bool is_damaged() const { return is_damaged_; }

 private:
  using Node = std::uint32_t;

  // Subtypes of nodes of kind kObject.
  enum class Part : std::uint8_t {
    kReconstruct,  // Functions and classes, by name.
    kScalar,
    kArrayClass,
    kTypeClass,
    kEncode,
    kFromBuffer,
    kWrapperClass,
    kOrderedDict,
    kType,     // A dtype: `text` is its code, `integer` its byte order.
    kShell,    // An array without content so far.
    kWrapper,  // joblib's wrapper: the bytes of the array follow its state.
    // PyTorch.
    kRebuildTensor,     // Functions and classes, by name.
    kRebuildParameter,  // Returns the tensor that it is given.
    kSizeClass,         // Returns the tuple that it is given.
    kWordClass,         // Returns the text that it is given: a device or an enum value.
    kStorageClass,      // `text` is the type of its elements.
    kStorage,           // `items` are the parts of its persistent id.
  };

  // Opcodes grouped by result. Each returns false for an opcode of another group.
  [[nodiscard]] Result<bool> read_plain(PickleOp op);
  [[nodiscard]] Result<bool> read_bytes(PickleOp op);
  [[nodiscard]] Result<bool> read_container(PickleOp op);
  [[nodiscard]] Result<bool> read_memo(PickleOp op);
  [[nodiscard]] Result<bool> read_object(PickleOp op);

  // pickle_arrays.cpp: results of the supported functions and classes.
  [[nodiscard]] Result<void> push_global(std::string_view module, std::string_view name);
  [[nodiscard]] Result<void> call();
  [[nodiscard]] Result<void> build();
  [[nodiscard]] Result<void> encode(const PickleNode& arguments);
  [[nodiscard]] Result<void> make_scalar(const PickleNode& arguments);
  [[nodiscard]] Result<void> array_from_buffer(const PickleNode& arguments);
  [[nodiscard]] Result<void> fill_shell(Node shell, const PickleNode& state);
  [[nodiscard]] Result<void> fill_with_objects(Node shell, const PickleNode& state);
  [[nodiscard]] Result<void> fill_wrapper(Node wrapper, const PickleNode& state);
  [[nodiscard]] Result<void> set_byte_order(Node type, const PickleNode& state);
  [[nodiscard]] Result<void> make_array(Node target, const PickleNode& type,
                                        const PickleNode& shape, bool fortran_order,
                                        std::string_view data);
  [[nodiscard]] Result<NpyLayout> array_layout(const PickleNode& type, const PickleNode& shape);

  // pickle_tensors.cpp: the same for PyTorch.
  [[nodiscard]] Result<bool> push_torch_global(std::string_view full_name);
  [[nodiscard]] Result<void> call_torch(Part callee, Node arguments);
  [[nodiscard]] Result<void> refer_to_storage();
  [[nodiscard]] Result<void> rebuild_tensor(const PickleNode& arguments);
  [[nodiscard]] Result<std::vector<std::size_t>> sizes_of(const PickleNode& tuple);

  [[nodiscard]] Result<std::string_view> take(std::uint64_t size);
  [[nodiscard]] Result<std::uint64_t> take_size(int bytes);
  [[nodiscard]] Result<std::string_view> take_line();
  [[nodiscard]] static std::size_t node_limit(std::size_t file_bytes);
  [[nodiscard]] Result<Node> pop();
  [[nodiscard]] Result<std::vector<Node>> pop_to_mark();
  [[nodiscard]] Result<void> push(PickleNode node);
  [[nodiscard]] Result<bool> push_sequence(PickleNode::Kind kind, std::size_t count);
  [[nodiscard]] Result<void> add_items(PickleNode::Kind kind, const std::vector<Node>& items);

  // PickleNode::detail of a string of Python 2, which may be text or the bytes of an array.
  static constexpr std::uint8_t kStringOfPython2 = 1;
  [[nodiscard]] static bool is_bytes(const PickleNode& found) {
    return found.kind == PickleNode::Kind::kBytes ||
           (found.kind == PickleNode::Kind::kText && found.detail == kStringOfPython2);
  }
  [[nodiscard]] PickleNode& node(Node index) { return document_.nodes_[index]; }
  [[nodiscard]] bool is_part(const PickleNode& found, Part part) const {
    return found.kind == PickleNode::Kind::kObject && found.detail == static_cast<int>(part);
  }
  [[nodiscard]] Failure fault(const std::string& message, std::string hint = {}) const;
  [[nodiscard]] Failure damage(const std::string& message);

  std::string_view bytes_;
  std::string file_;
  PickleDocument& document_;
  Dialect dialect_;
  std::size_t max_nodes_;
  std::size_t at_ = 0;
  std::size_t opcode_at_ = 0;  // Offset of the current opcode.
  std::vector<Node> stack_;
  std::vector<std::size_t> marks_;
  std::map<std::uint64_t, Node> memo_;
  std::size_t array_bytes_ = 0;    // Total of all arrays.
  std::size_t encoded_bytes_ = 0;  // Total of all encoded strings.
  bool is_damaged_ = false;
};

}  // namespace retarget
