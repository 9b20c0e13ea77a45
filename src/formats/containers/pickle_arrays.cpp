// Results of the functions and classes that a pickle may name: arrays of NumPy and joblib.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "base/try.h"
#include "formats/containers/npy.h"
#include "formats/containers/pickle.h"
#include "formats/containers/pickle_reader.h"

namespace retarget {
namespace {

using Kind = PickleNode::Kind;

// Shortens a name from a file for a message.
std::string short_name(std::string_view text) {
  constexpr std::size_t kMaxLength = 80;
  std::string shown(text.substr(0, kMaxLength));
  std::ranges::replace_if(
      shown, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
  return text.size() > kMaxLength ? shown + "..." : shown;
}

// NumPy 2 renamed numpy.core to numpy._core.
std::string canonical_name(std::string_view module, std::string_view name) {
  constexpr std::string_view kNew = "numpy._core";
  std::string full(module);
  if (full == kNew || full.starts_with("numpy._core.")) full.replace(0, kNew.size(), "numpy.core");
  return full + "." + std::string(name);
}

std::string refusal_hint(std::string_view name, bool in_torch_file) {
  if (in_torch_file) {
    return "only plain values and tensors are read, and nothing is executed: save a dictionary of "
           "tensors with torch.save";
  }
  if (name.starts_with("torch.")) {
    return "save NumPy arrays: tensor.cpu().numpy() before pickle.dump";
  }
  return "only plain values and NumPy arrays are read, and nothing is executed";
}

}  // namespace

Result<void> PickleReader::push_global(std::string_view module, std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Part>, 8> kKnown = {{
      {"numpy.core.multiarray._reconstruct", Part::kReconstruct},
      {"numpy.core.multiarray.scalar", Part::kScalar},
      {"numpy.ndarray", Part::kArrayClass},
      {"numpy.dtype", Part::kTypeClass},
      {"_codecs.encode", Part::kEncode},
      {"numpy.core.numeric._frombuffer", Part::kFromBuffer},
      {"joblib.numpy_pickle.NumpyArrayWrapper", Part::kWrapperClass},
      {"collections.OrderedDict", Part::kOrderedDict},
  }};
  constexpr std::size_t kMaxNameLength = 200;
  const bool short_enough = module.size() < kMaxNameLength && name.size() < kMaxNameLength;
  const std::string full = short_enough ? canonical_name(module, name) : std::string();
  if (dialect_ == Dialect::kTorch) {
    TRY_ASSIGN(const auto is_torch, push_torch_global(full));
    if (is_torch) return {};
  }
  for (const auto& [known, part] : kKnown) {
    if (known != full) continue;
    PickleNode made;
    made.kind = Kind::kObject;
    made.detail = static_cast<std::uint8_t>(part);
    return push(std::move(made));
  }
  return fault(
      "the pickle names " + short_name(module) + "." + short_name(name) + ", which is not allowed",
      refusal_hint(short_name(module) + ".", dialect_ == Dialect::kTorch));
}

Result<void> PickleReader::call() {
  TRY_ASSIGN(const auto arguments_node, pop());
  TRY_ASSIGN(const auto callee_node, pop());
  const PickleNode& arguments = node(arguments_node);
  const PickleNode& callee = node(callee_node);
  if (callee.kind != Kind::kObject || arguments.kind != Kind::kTuple) {
    return fault("the pickle calls something that is not a function");
  }
  const auto part = static_cast<Part>(callee.detail);
  if (part >= Part::kRebuildTensor) return call_torch(part, arguments_node);
  PickleNode made;
  made.kind = Kind::kObject;
  switch (part) {
    case Part::kReconstruct:
      if (arguments.items.empty() || !is_part(node(arguments.items[0]), Part::kArrayClass)) {
        return fault("the pickle creates an array of a class other than numpy.ndarray");
      }
      made.detail = static_cast<std::uint8_t>(Part::kShell);
      return push(std::move(made));
    case Part::kTypeClass:
      if (arguments.items.empty() || node(arguments.items[0]).kind != Kind::kText) {
        return fault("the pickle creates a dtype without a name");
      }
      made.detail = static_cast<std::uint8_t>(Part::kType);
      made.text = node(arguments.items[0]).text;
      made.integer = '<';
      return push(std::move(made));
    case Part::kWrapperClass:
      made.detail = static_cast<std::uint8_t>(Part::kWrapper);
      return push(std::move(made));
    case Part::kOrderedDict:
      if (!arguments.items.empty()) {
        return fault("the pickle fills an OrderedDict in an unsupported way");
      }
      made.kind = Kind::kDict;
      return push(std::move(made));
    case Part::kEncode:
      return encode(arguments);
    case Part::kScalar:
      return make_scalar(arguments);
    case Part::kFromBuffer:
      return array_from_buffer(arguments);
    default:
      return fault("the pickle calls something that is not a function");
  }
}

// Protocol 2 has no bytes type. It stores bytes as text and a call that encodes it as latin1.
Result<void> PickleReader::encode(const PickleNode& arguments) {
  if (arguments.items.size() != 2 || node(arguments.items[0]).kind != Kind::kText ||
      (node(arguments.items[1]).text != "latin1" && node(arguments.items[1]).text != "latin-1")) {
    return fault("the pickle encodes a string in an unsupported way");
  }
  const std::string_view text = node(arguments.items[0]).text;
  encoded_bytes_ += text.size();
  if (encoded_bytes_ > bytes_.size()) return fault("the pickle repeats its strings too often");
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto first = static_cast<unsigned char>(text[i]);
    if (first < 0x80) {
      bytes += text[i];
      continue;
    }
    // U+0080 to U+00FF take two bytes in UTF-8.
    const bool two = (first == 0xC2 || first == 0xC3) && i + 1 < text.size();
    if (!two) return fault("the pickle encodes a string that is not latin1");
    bytes += static_cast<char>(((first & 3) << 6) | (static_cast<unsigned char>(text[++i]) & 0x3F));
  }
  document_.texts_.push_back(std::move(bytes));
  PickleNode made;
  made.kind = Kind::kBytes;
  made.text = document_.texts_.back();
  return push(std::move(made));
}

Result<NpyLayout> PickleReader::array_layout(const PickleNode& type, const PickleNode& shape) {
  if (!is_part(type, Part::kType)) return fault("the pickle has an array without a dtype");
  if (shape.kind != Kind::kTuple || shape.items.size() > 32) {
    return fault("the pickle has an array without a shape");
  }
  NpyHeader header;
  header.type = std::string(1, static_cast<char>(type.integer)) + std::string(type.text);
  for (const Node item : shape.items) {
    const PickleNode& length = node(item);
    if (length.kind != Kind::kInteger || length.integer < 0) {
      return fault("the pickle has an array without a shape");
    }
    header.shape.push_back(static_cast<std::size_t>(length.integer));
  }
  auto layout = npy_layout(header);
  if (!layout) return fault(layout.error().message, layout.error().hint);
  return layout;
}

Result<void> PickleReader::make_array(Node target, const PickleNode& type, const PickleNode& shape,
                                      bool fortran_order, std::string_view data) {
  TRY_ASSIGN(auto layout, array_layout(type, shape));
  if (layout.data_size != data.size()) {
    return fault(fmt::format("the pickle has an array of {1} bytes, expected {0}", layout.data_size,
                             data.size()));
  }
  array_bytes_ += data.size();
  if (array_bytes_ > bytes_.size()) return fault("the pickle repeats its arrays too often");
  document_.arrays_.push_back(npy_with_data(std::move(layout), std::string(data), fortran_order));
  PickleNode& made = node(target);
  made.kind = Kind::kArray;
  made.integer = static_cast<std::int64_t>(document_.arrays_.size()) - 1;
  return {};
}

Result<void> PickleReader::make_scalar(const PickleNode& arguments) {
  if (arguments.items.size() != 2 || !is_bytes(node(arguments.items[1]))) {
    return fault("the pickle has a NumPy scalar without its value");
  }
  const PickleNode& type = node(arguments.items[0]);
  const std::string_view data = node(arguments.items[1]).text;
  TRY(push({}));
  PickleNode no_shape;
  no_shape.kind = Kind::kTuple;
  return make_array(stack_.back(), type, no_shape, false, data);
}

Result<void> PickleReader::array_from_buffer(const PickleNode& arguments) {
  if (arguments.items.size() != 4 || !is_bytes(node(arguments.items[0]))) {
    return fault("the pickle has an array buffer without its bytes");
  }
  const bool fortran_order = node(arguments.items[3]).text == "F";
  const std::string_view data = node(arguments.items[0]).text;
  const PickleNode& type = node(arguments.items[1]);
  const PickleNode& shape = node(arguments.items[2]);
  TRY(push({}));
  return make_array(stack_.back(), type, shape, fortran_order, data);
}

Result<void> PickleReader::build() {
  TRY_ASSIGN(const auto state, pop());
  TRY_ASSIGN(const auto target, pop());
  stack_.push_back(target);
  const PickleNode& object = node(target);
  if (is_part(object, Part::kShell)) return fill_shell(target, node(state));
  if (is_part(object, Part::kWrapper)) return fill_wrapper(target, node(state));
  if (is_part(object, Part::kType)) return set_byte_order(target, node(state));
  // PyTorch gives dictionaries of weights a state with layer versions; ignore it.
  if (dialect_ == Dialect::kTorch && object.kind == Kind::kDict) return {};
  return fault("the pickle sets the state of an object without state");
}

// State: (version, shape, dtype, is Fortran order, bytes).
Result<void> PickleReader::fill_shell(Node shell, const PickleNode& state) {
  if (state.kind != Kind::kTuple || state.items.size() != 5) {
    return fault("the pickle has an array with an unsupported state");
  }
  if (node(state.items[4]).kind == Kind::kList) return fill_with_objects(shell, state);
  if (!is_bytes(node(state.items[4]))) {
    return fault("the pickle has an array of Python objects, which is not allowed",
                 "save arrays of numbers");
  }
  return make_array(shell, node(state.items[2]), node(state.items[1]),
                    node(state.items[3]).integer != 0, node(state.items[4]).text);
}

// An object array holds a list. numpy.save turns a dictionary into such an array.
Result<void> PickleReader::fill_with_objects(Node shell, const PickleNode& state) {
  const PickleNode& type = node(state.items[2]);
  if (!is_part(type, Part::kType) || !type.text.starts_with('O')) {
    return fault("the pickle has an array of numbers without their bytes");
  }
  const std::vector<Node> items = node(state.items[4]).items;
  // Each item needs an opcode in the file, unless one list is used repeatedly; limit the total.
  array_bytes_ += items.size();
  if (array_bytes_ > bytes_.size()) return fault("the pickle repeats its arrays too often");
  PickleNode& made = node(shell);
  made.kind = Kind::kList;
  const auto has_many = [&](Node length) { return node(length).integer > 1; };
  made.detail = std::ranges::count_if(node(state.items[1]).items, has_many) > 1
                    ? PickleNode::kObjectTable
                    : std::uint8_t{0};
  made.items = items;
  return {};
}

// State: joblib's dictionary. Padding and the bytes of the array follow outside of any opcode.
Result<void> PickleReader::fill_wrapper(Node wrapper, const PickleNode& state) {
  const PickleNode* type = document_.find(state, "dtype");
  const PickleNode* shape = document_.find(state, "shape");
  const PickleNode* order = document_.find(state, "order");
  const PickleNode* alignment = document_.find(state, "numpy_array_alignment_bytes");
  if (type == nullptr || shape == nullptr || order == nullptr) {
    return fault("the pickle has a NumpyArrayWrapper without dtype, shape or order");
  }
  TRY_ASSIGN(const auto layout, array_layout(*type, *shape));
  if (alignment != nullptr && alignment->kind != Kind::kNone) {
    TRY_ASSIGN(const auto padding, take_size(1));
    TRY(take(padding));
  }
  TRY_ASSIGN(const auto data, take(layout.data_size));
  return make_array(wrapper, *type, *shape, order->text == "F", data);
}

// State: (3, byte order, None, None, None, -1, -1, 0).
Result<void> PickleReader::set_byte_order(Node type, const PickleNode& state) {
  const bool sound = state.kind == Kind::kTuple && state.items.size() >= 2 &&
                     node(state.items[1]).kind == Kind::kText &&
                     node(state.items[1]).text.size() == 1;
  if (!sound) return fault("the pickle has a dtype with an unsupported state");
  const char order = node(state.items[1]).text.front();
  node(type).integer = static_cast<unsigned char>(order == '=' ? '<' : order);
  return {};
}

}  // namespace retarget
