#include "formats/containers/array_source.h"

#include <fmt/format.h>
#include <algorithm>

#include "retarget/text.h"

namespace retarget {
namespace {

// A list of numbers as a 1-D array. Returns nothing for other lists.
std::optional<NpyArray> row_of(const PickleDocument& document, const PickleNode& list) {
  std::vector<double> numbers;
  for (const std::uint32_t item : list.items) {
    const PickleNode& node = document.at(item);
    const auto number =
        node.kind == PickleNode::Kind::kArray ? std::nullopt : document.number(node);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return float64_array(numbers, {numbers.size()});
}

// A list of ASCII strings as a 1-D array. Returns nothing for other lists.
std::optional<NpyArray> text_row_of(const PickleDocument& document, const PickleNode& list) {
  std::vector<std::string> texts;
  for (const std::uint32_t item : list.items) {
    const PickleNode& node = document.at(item);
    const bool is_plain =
        node.kind == PickleNode::Kind::kText &&
        std::ranges::all_of(node.text, [](char c) { return c >= 0x20 && c < 0x7F; });
    if (!is_plain) return std::nullopt;
    texts.emplace_back(node.text);
  }
  return text_array(texts);
}

// Python's name of a kind, for messages.
const char* word_of(PickleNode::Kind kind) {
  switch (kind) {
    case PickleNode::Kind::kNone:
      return "None";
    case PickleNode::Kind::kDict:
      return "a dictionary";
    case PickleNode::Kind::kList:
    case PickleNode::Kind::kTuple:
      return "a list";
    default:
      return "an object";
  }
}

}  // namespace

Result<std::string> FileArrays::type_of(std::string_view name) const {
  if (!has(name)) return no_such_array(name);
  return std::string();
}

Failure FileArrays::fault(std::string_view array, std::string message, std::string hint) const {
  if (!array.empty()) message = fmt::format("array \"{}\": {}", array, message);
  return input_failure(file_name_, std::move(message), std::move(hint));
}

Failure FileArrays::no_such_array(std::string_view name) const {
  return file_failure("no array \"" + std::string(name) + "\"" + did_you_mean(name, names()) +
                      "; found " + list_names(names(), 20));
}

std::vector<std::string> MadeArrays::names() const {
  std::vector<std::string> names;
  for (const auto& [name, array] : arrays_) names.push_back(name);
  return names;
}

Result<NpyArray> MadeArrays::read(std::string_view name) const {
  const auto found = arrays_.find(name);
  if (found == arrays_.end()) return no_such_array(name);
  return found->second;
}

std::vector<std::string> DictionaryArrays::names() const {
  std::vector<std::string> names = document().keys(dictionary_);
  for (std::string& name : names) name = printable(name);
  return names;
}

bool DictionaryArrays::has(std::string_view name) const {
  return document().find(dictionary_, name) != nullptr;
}

Result<std::string> DictionaryArrays::type_of(std::string_view name) const {
  const PickleNode* node = document().find(dictionary_, name);
  if (node == nullptr) return no_such_array(name);
  const bool is_value = node->kind != PickleNode::Kind::kNone &&
                        node->kind != PickleNode::Kind::kDict &&
                        node->kind != PickleNode::Kind::kObject;
  return std::string(is_value ? "" : "|O");
}

Result<NpyArray> DictionaryArrays::read(std::string_view name) const {
  using Kind = PickleNode::Kind;
  const PickleNode* node = document().find(dictionary_, name);
  if (node == nullptr) return no_such_array(name);
  switch (node->kind) {
    case Kind::kArray:
      return document().array(*node);
    case Kind::kTensor:
      return torch_->read(*node, name);
    case Kind::kBool:
    case Kind::kInteger:
    case Kind::kNumber:
      return float64_array(std::vector<double>{*document().number(*node)}, {});
    case Kind::kText:
    case Kind::kBytes:
      return text_array(std::vector<std::string>{std::string(node->text)}, true);
    case Kind::kList:
    case Kind::kTuple:
      if (node->detail == PickleNode::kObjectTable) {
        return array_failure(name, "expected an array of numbers, found one of Python objects",
                             "save it with array.astype(float)");
      }
      if (auto row = row_of(document(), *node)) return std::move(*row);
      if (auto row = text_row_of(document(), *node)) return std::move(*row);
      break;
    default:
      break;
  }
  return array_failure(name,
                       std::string("expected an array of numbers, found ") + word_of(node->kind));
}

}  // namespace retarget
