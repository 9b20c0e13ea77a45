// Results of the functions and classes that a PyTorch pickle may name: layouts of tensors.

#include <fmt/format.h>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "base/try.h"
#include "formats/containers/npy.h"
#include "formats/containers/pickle_reader.h"

namespace retarget {
namespace {

// Files of motions and weights stay well below these limits.
constexpr std::size_t kMaxTensorDimensions = 8;
constexpr std::size_t kMaxTensors = 200'000;

struct StorageType {
  std::string_view name;
  std::string_view type;
};

constexpr std::array<StorageType, 10> kStorageTypes = {{
    {"torch.DoubleStorage", "f8"},
    {"torch.FloatStorage", "f4"},
    {"torch.HalfStorage", "f2"},
    {"torch.BFloat16Storage", "bf16"},
    {"torch.LongStorage", "i8"},
    {"torch.IntStorage", "i4"},
    {"torch.ShortStorage", "i2"},
    {"torch.CharStorage", "i1"},
    {"torch.ByteStorage", "u1"},
    {"torch.BoolStorage", "b1"},
}};

// Offset of the last element of a view from its first. Returns nothing on overflow.
std::optional<std::uint64_t> reach_of(const PickleTensor& tensor) {
  constexpr std::uint64_t kMax = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t reach = 0;
  for (std::size_t i = 0; i < tensor.shape.size(); ++i) {
    const std::uint64_t steps = tensor.shape[i] - 1, stride = tensor.strides[i];
    if (stride != 0 && steps > (kMax - reach) / stride) return std::nullopt;
    reach += steps * stride;
  }
  return reach;
}

bool is_empty(const PickleTensor& tensor) {
  for (const std::size_t size : tensor.shape) {
    if (size == 0) return true;
  }
  return false;
}

}  // namespace

Result<bool> PickleReader::push_torch_global(std::string_view full_name) {
  constexpr std::array<std::pair<std::string_view, Part>, 6> kKnown = {{
      {"torch._utils._rebuild_tensor_v2", Part::kRebuildTensor},
      {"torch._utils._rebuild_tensor", Part::kRebuildTensor},
      {"torch._utils._rebuild_parameter", Part::kRebuildParameter},
      {"torch.Size", Part::kSizeClass},
      {"torch.device", Part::kWordClass},
      {"protomotions.simulator.base_simulator.simulator_state.StateConversion", Part::kWordClass},
  }};
  PickleNode made;
  made.kind = PickleNode::Kind::kObject;
  for (const auto& [name, part] : kKnown) {
    if (name != full_name) continue;
    made.detail = static_cast<std::uint8_t>(part);
    TRY(push(std::move(made)));
    return true;
  }
  for (const StorageType& storage : kStorageTypes) {
    if (storage.name != full_name) continue;
    made.detail = static_cast<std::uint8_t>(Part::kStorageClass);
    made.text = storage.type;
    TRY(push(std::move(made)));
    return true;
  }
  return false;
}

Result<void> PickleReader::call_torch(Part callee, Node arguments_node) {
  const PickleNode& arguments = node(arguments_node);
  const auto give_first = [&](PickleNode::Kind kind) -> Result<void> {
    if (arguments.items.empty() || node(arguments.items[0]).kind != kind) {
      return fault("the pickle creates a PyTorch value in an unsupported way");
    }
    stack_.push_back(arguments.items[0]);
    return {};
  };
  switch (callee) {
    case Part::kRebuildTensor:
      return rebuild_tensor(arguments);
    case Part::kRebuildParameter:
      return give_first(PickleNode::Kind::kTensor);
    case Part::kSizeClass:
      return give_first(PickleNode::Kind::kTuple);
    case Part::kWordClass:
      return give_first(PickleNode::Kind::kText);
    default:
      return fault("the pickle calls something that is not a function");
  }
}

// A persistent id: ('storage', class, key, device, element count).
Result<void> PickleReader::refer_to_storage() {
  TRY_ASSIGN(const auto id, pop());
  const PickleNode& parts = node(id);
  const bool sound = parts.kind == PickleNode::Kind::kTuple && parts.items.size() == 5 &&
                     node(parts.items[0]).kind == PickleNode::Kind::kText &&
                     node(parts.items[0]).text == "storage" &&
                     is_part(node(parts.items[1]), Part::kStorageClass) &&
                     node(parts.items[2]).kind == PickleNode::Kind::kText &&
                     node(parts.items[4]).kind == PickleNode::Kind::kInteger &&
                     node(parts.items[4]).integer >= 0;
  if (!sound) return fault("the pickle refers to a value that is not a number storage");
  PickleNode made;
  made.kind = PickleNode::Kind::kObject;
  made.detail = static_cast<std::uint8_t>(Part::kStorage);
  made.items = parts.items;
  return push(std::move(made));
}

Result<std::vector<std::size_t>> PickleReader::sizes_of(const PickleNode& tuple) {
  std::vector<std::size_t> sizes;
  bool sound = tuple.kind == PickleNode::Kind::kTuple && tuple.items.size() <= kMaxTensorDimensions;
  for (std::size_t i = 0; sound && i < tuple.items.size(); ++i) {
    const PickleNode& size = node(tuple.items[i]);
    sound = size.kind == PickleNode::Kind::kInteger && size.integer >= 0;
    sizes.push_back(static_cast<std::size_t>(size.integer));
  }
  if (!sound) return fault("the pickle has a tensor without a shape or strides");
  return sizes;
}

// Arguments: (storage, offset, size, strides, ...). The remaining ones concern gradients.
Result<void> PickleReader::rebuild_tensor(const PickleNode& arguments) {
  if (arguments.items.size() < 4 || !is_part(node(arguments.items[0]), Part::kStorage) ||
      node(arguments.items[1]).kind != PickleNode::Kind::kInteger ||
      node(arguments.items[1]).integer < 0) {
    return fault("the pickle creates a tensor in an unsupported way");
  }
  const PickleNode& storage = node(arguments.items[0]);
  PickleTensor tensor;
  tensor.type = node(storage.items[1]).text;
  tensor.storage = node(storage.items[2]).text;
  tensor.storage_count = static_cast<std::uint64_t>(node(storage.items[4]).integer);
  tensor.offset = static_cast<std::uint64_t>(node(arguments.items[1]).integer);
  TRY_ASSIGN(tensor.shape, sizes_of(node(arguments.items[2])));
  TRY_ASSIGN(tensor.strides, sizes_of(node(arguments.items[3])));
  if (tensor.shape.size() != tensor.strides.size()) {
    return fault("the pickle has a tensor whose strides do not match its shape");
  }
  const auto reach = is_empty(tensor) ? 0 : reach_of(tensor);
  const bool inside = reach && tensor.offset <= tensor.storage_count &&
                      (is_empty(tensor) || *reach < tensor.storage_count - tensor.offset);
  if (!inside) {
    return fault(fmt::format("a tensor of shape {} exceeds its storage of {} numbers",
                             shape_text(tensor.shape), tensor.storage_count));
  }
  if (document_.tensors_.size() >= kMaxTensors) return fault("the pickle creates too many tensors");
  document_.tensors_.push_back(std::move(tensor));
  PickleNode made;
  made.kind = PickleNode::Kind::kTensor;
  made.integer = static_cast<std::int64_t>(document_.tensors_.size()) - 1;
  return push(std::move(made));
}

}  // namespace retarget
