#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/npy_stream.h"
#include "base/pickle.h"
#include "base/pickle_opcodes.h"
#include "retarget/error.h"

namespace retarget {

/// Walks over a pickle's opcodes and builds its document; see read_pickle.
class PickleReader {
 public:
  /// What may be in a pickle beside plain values and NumPy arrays.
  enum class Dialect : std::uint8_t { kPlain, kTorch };

  PickleReader(std::string_view bytes, std::string file, PickleDocument& document,
               Dialect dialect = Dialect::kPlain)
      : bytes_(bytes), file_(std::move(file)), document_(document), dialect_(dialect) {}

  [[nodiscard]] Result<void> read();

 private:
  using Node = std::uint32_t;

  // what a node of kind kObject is
  enum class Part : std::uint8_t {
    kReconstruct,  // functions and classes, by name
    kScalar,
    kArrayClass,
    kTypeClass,
    kEncode,
    kFromBuffer,
    kWrapperClass,
    kOrderedDict,
    kType,     // a dtype: text is its code, integer its byte order
    kShell,    // an array still without content
    kWrapper,  // joblib's: the array's bytes follow its state
    // PyTorch's
    kRebuildTensor,     // functions and classes, by name
    kRebuildParameter,  // the tensor that it is given
    kSizeClass,         // the tuple that it is given
    kWordClass,         // the text that it is given: a device, a word of an enum
    kStorageClass,      // text is the type of its elements
    kStorage,           // items are the parts of its persistent id
  };

  // opcodes by what they make; false: the opcode is of another group
  [[nodiscard]] Result<bool> read_plain(PickleOp op);
  [[nodiscard]] Result<bool> read_bytes(PickleOp op);
  [[nodiscard]] Result<bool> read_container(PickleOp op);
  [[nodiscard]] Result<bool> read_memo(PickleOp op);
  [[nodiscard]] Result<bool> read_object(PickleOp op);

  // pickle_arrays.cpp: what named functions and classes make
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

  // pickle_tensors.cpp: the same of PyTorch's
  [[nodiscard]] Result<bool> push_torch_global(std::string_view full_name);
  [[nodiscard]] Result<void> call_torch(Part callee, Node arguments);
  [[nodiscard]] Result<void> refer_to_storage();
  [[nodiscard]] Result<void> rebuild_tensor(const PickleNode& arguments);
  [[nodiscard]] Result<std::vector<std::size_t>> sizes_of(const PickleNode& tuple);

  [[nodiscard]] Result<std::string_view> take(std::uint64_t size);
  [[nodiscard]] Result<std::uint64_t> take_size(int bytes);
  [[nodiscard]] Result<std::string_view> take_line();
  [[nodiscard]] Result<Node> pop();
  [[nodiscard]] Result<std::vector<Node>> pop_to_mark();
  [[nodiscard]] Result<void> push(PickleNode node);
  [[nodiscard]] Result<bool> push_sequence(PickleNode::Kind kind, std::size_t count);
  [[nodiscard]] Result<void> add_items(PickleNode::Kind kind, const std::vector<Node>& items);

  [[nodiscard]] PickleNode& node(Node index) { return document_.nodes_[index]; }
  [[nodiscard]] bool is_part(const PickleNode& found, Part part) const {
    return found.kind == PickleNode::Kind::kObject && found.detail == static_cast<int>(part);
  }
  [[nodiscard]] Failure fault(const std::string& message, std::string hint = {}) const;

  std::string_view bytes_;
  std::string file_;
  PickleDocument& document_;
  Dialect dialect_;
  std::size_t at_ = 0;
  std::size_t opcode_at_ = 0;  // of the opcode that is being read
  std::vector<Node> stack_;
  std::vector<std::size_t> marks_;
  std::map<std::uint64_t, Node> memo_;
  std::size_t array_bytes_ = 0;    // of all arrays together
  std::size_t encoded_bytes_ = 0;  // of all encoded texts
};

}  // namespace retarget
