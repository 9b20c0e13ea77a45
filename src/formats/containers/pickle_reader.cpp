#include "formats/containers/pickle_reader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "base/try.h"
#include "retarget/text.h"

namespace retarget {
namespace {

using Kind = PickleNode::Kind;

// Values that any file may have, and bytes of larger files per value. A value of a file takes 64
// bytes in memory, and 9 in the file if it is a number with decimals.
constexpr std::size_t kFreeNodes = 2'000'000;
constexpr std::size_t kBytesOfNode = 4;

std::uint64_t unsigned_of(std::string_view bytes) {
  return little_endian(bytes, 0, bytes.size());
}

// Decodes two's complement in little-endian order.
std::int64_t signed_of(std::string_view bytes) {
  if (bytes.empty()) return 0;
  std::uint64_t value = unsigned_of(bytes);
  const int bits = static_cast<int>(8 * bytes.size());
  if (bits < 64 && (value >> (bits - 1)) != 0) value |= ~std::uint64_t{0} << bits;
  return std::bit_cast<std::int64_t>(value);
}

}  // namespace

std::size_t PickleReader::node_limit(std::size_t file_bytes) {
  return std::max(kFreeNodes, file_bytes / kBytesOfNode);
}

Failure PickleReader::fault(const std::string& message, std::string hint) const {
  return input_failure(file_, message + " (byte " + std::to_string(opcode_at_) + " of the pickle)",
                       std::move(hint));
}

Failure PickleReader::damage(const std::string& message) {
  is_damaged_ = true;
  return fault(message);
}

Result<std::string_view> PickleReader::take(std::uint64_t size) {
  if (size > bytes_.size() - at_) {
    return damage("the pickle is cut off: " + std::to_string(size) + " bytes should follow, " +
                  std::to_string(bytes_.size() - at_) + " remain");
  }
  const std::string_view taken = bytes_.substr(at_, static_cast<std::size_t>(size));
  at_ += taken.size();
  return taken;
}

Result<std::uint64_t> PickleReader::take_size(int bytes) {
  TRY_ASSIGN(const auto taken, take(static_cast<std::uint64_t>(bytes)));
  return unsigned_of(taken);
}

Result<std::string_view> PickleReader::take_line() {
  const std::size_t end = bytes_.find('\n', at_);
  if (end == std::string_view::npos) return damage("the pickle is cut off within a name");
  const std::string_view line = bytes_.substr(at_, end - at_);
  at_ = end + 1;
  return line;
}

Result<PickleReader::Node> PickleReader::pop() {
  const std::size_t floor = marks_.empty() ? 0 : marks_.back();
  if (stack_.size() <= floor) return damage("the pickle uses a value that it never created");
  const Node top = stack_.back();
  stack_.pop_back();
  return top;
}

Result<std::vector<PickleReader::Node>> PickleReader::pop_to_mark() {
  if (marks_.empty()) return damage("the pickle ends a list that it never started");
  const auto begin = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
  std::vector<Node> items(begin, stack_.end());
  stack_.erase(begin, stack_.end());
  marks_.pop_back();
  return items;
}

Result<void> PickleReader::push(PickleNode made) {
  if (document_.nodes_.size() >= max_nodes_) {
    return fault("the pickle has more than " + std::to_string(max_nodes_) +
                 " values, too many for a motion of its size");
  }
  stack_.push_back(static_cast<Node>(document_.nodes_.size()));
  document_.nodes_.push_back(std::move(made));
  return {};
}

Result<bool> PickleReader::read_plain(PickleOp op) {
  PickleNode made;
  int size = 0;
  switch (op) {
    case PickleOp::kNone:
      break;
    case PickleOp::kNewTrue:
    case PickleOp::kNewFalse:
      made.kind = Kind::kBool;
      made.integer = op == PickleOp::kNewTrue ? 1 : 0;
      break;
    case PickleOp::kBinInt1:
    case PickleOp::kBinInt2:
    case PickleOp::kBinInt:
    case PickleOp::kLong1: {
      made.kind = Kind::kInteger;
      size = op == PickleOp::kBinInt1 ? 1 : op == PickleOp::kBinInt2 ? 2 : 4;
      if (op == PickleOp::kLong1) {
        TRY_ASSIGN(const auto length, take_size(1));
        if (length > 8) return fault("the pickle contains an integer of more than 64 bits");
        size = static_cast<int>(length);
      }
      TRY_ASSIGN(const auto bytes, take(static_cast<std::uint64_t>(size)));
      const bool has_sign = op == PickleOp::kBinInt || op == PickleOp::kLong1;
      made.integer = has_sign ? signed_of(bytes) : static_cast<std::int64_t>(unsigned_of(bytes));
      break;
    }
    case PickleOp::kBinFloat: {
      TRY_ASSIGN(const auto bytes, take(8));
      // This is the only big-endian number of the format.
      const std::string reversed(bytes.rbegin(), bytes.rend());
      made.kind = Kind::kNumber;
      made.number = std::bit_cast<double>(unsigned_of(reversed));
      break;
    }
    default:
      return false;
  }
  TRY(push(std::move(made)));
  return true;
}

Result<bool> PickleReader::read_bytes(PickleOp op) {
  int length_bytes = 0;
  PickleNode made;
  made.kind = Kind::kText;
  switch (op) {
    case PickleOp::kShortBinUnicode:
      length_bytes = 1;
      break;
    case PickleOp::kBinUnicode:
      length_bytes = 4;
      break;
    case PickleOp::kBinUnicode8:
      length_bytes = 8;
      break;
    case PickleOp::kShortBinString:
    case PickleOp::kBinString:
      length_bytes = op == PickleOp::kShortBinString ? 1 : 4;
      made.detail = kStringOfPython2;
      break;
    case PickleOp::kShortBinBytes:
      length_bytes = 1;
      made.kind = Kind::kBytes;
      break;
    case PickleOp::kBinBytes:
      length_bytes = 4;
      made.kind = Kind::kBytes;
      break;
    case PickleOp::kBinBytes8:
    case PickleOp::kByteArray8:
      length_bytes = 8;
      made.kind = Kind::kBytes;
      break;
    default:
      return false;
  }
  TRY_ASSIGN(const auto length, take_size(length_bytes));
  TRY_ASSIGN(const auto bytes, take(length));
  made.text = bytes;
  TRY(push(std::move(made)));
  return true;
}

// Pushes a tuple or list of the last `count` values.
Result<bool> PickleReader::push_sequence(Kind kind, std::size_t count) {
  PickleNode made;
  made.kind = kind;
  for (std::size_t i = 0; i < count; ++i) {
    TRY_ASSIGN(const auto item, pop());
    made.items.push_back(item);
  }
  std::ranges::reverse(made.items);
  TRY(push(std::move(made)));
  return true;
}

Result<void> PickleReader::add_items(Kind kind, const std::vector<Node>& items) {
  TRY_ASSIGN(const auto target, pop());
  stack_.push_back(target);
  PickleNode& container = node(target);
  if (container.kind != kind || (kind == Kind::kDict && items.size() % 2 != 0)) {
    return damage("the pickle adds values to an object that cannot hold them");
  }
  container.items.insert(container.items.end(), items.begin(), items.end());
  return {};
}

Result<bool> PickleReader::read_container(PickleOp op) {
  switch (op) {
    case PickleOp::kMark:
      // Marks create no nodes, so limit them separately.
      if (marks_.size() >= max_nodes_) return fault("the pickle nests lists too deeply");
      marks_.push_back(stack_.size());
      return true;
    case PickleOp::kEmptyTuple:
      return push_sequence(Kind::kTuple, 0);
    case PickleOp::kEmptyList:
      return push_sequence(Kind::kList, 0);
    case PickleOp::kEmptyDict:
      return push_sequence(Kind::kDict, 0);
    case PickleOp::kTuple1:
      return push_sequence(Kind::kTuple, 1);
    case PickleOp::kTuple2:
      return push_sequence(Kind::kTuple, 2);
    case PickleOp::kTuple3:
      return push_sequence(Kind::kTuple, 3);
    case PickleOp::kTuple:
    case PickleOp::kList:
    case PickleOp::kDict: {
      TRY_ASSIGN(auto items, pop_to_mark());
      if (op == PickleOp::kDict && items.size() % 2 != 0) {
        return damage("the pickle has a dictionary key without its value");
      }
      PickleNode made;
      made.kind = op == PickleOp::kTuple  ? Kind::kTuple
                  : op == PickleOp::kList ? Kind::kList
                                          : Kind::kDict;
      made.items = std::move(items);
      TRY(push(std::move(made)));
      return true;
    }
    case PickleOp::kAppends:
    case PickleOp::kSetItems: {
      TRY_ASSIGN(const auto items, pop_to_mark());
      const Kind kind = op == PickleOp::kAppends ? Kind::kList : Kind::kDict;
      TRY(add_items(kind, items));
      return true;
    }
    case PickleOp::kAppend:
    case PickleOp::kSetItem: {
      std::vector<Node> items;
      for (int left = op == PickleOp::kAppend ? 1 : 2; left > 0; --left) {
        TRY_ASSIGN(const auto item, pop());
        items.insert(items.begin(), item);
      }
      const Kind kind = op == PickleOp::kAppend ? Kind::kList : Kind::kDict;
      TRY(add_items(kind, items));
      return true;
    }
    default:
      return false;
  }
}

Result<bool> PickleReader::read_memo(PickleOp op) {
  const bool puts = op == PickleOp::kBinPut || op == PickleOp::kLongBinPut;
  const bool gets = op == PickleOp::kBinGet || op == PickleOp::kLongBinGet;
  if (!puts && !gets && op != PickleOp::kMemoize) return false;
  std::uint64_t number = memo_.size();
  if (op != PickleOp::kMemoize) {
    const bool is_long = op == PickleOp::kLongBinPut || op == PickleOp::kLongBinGet;
    TRY_ASSIGN(const auto index, take_size(is_long ? 4 : 1));
    number = index;
  }
  if (gets) {
    const auto found = memo_.find(number);
    if (found == memo_.end()) {
      return damage("the pickle refers to its value " + std::to_string(number) +
                    ", which it never stored");
    }
    if (stack_.size() >= 2 * max_nodes_) return fault("the pickle repeats a value too often");
    stack_.push_back(found->second);
    return true;
  }
  if (stack_.empty()) return damage("the pickle stores a value that it never created");
  if (memo_.size() >= max_nodes_) return fault("the pickle stores more values than it can have");
  memo_.insert_or_assign(number, stack_.back());
  return true;
}

Result<bool> PickleReader::read_object(PickleOp op) {
  Result<void> done;
  switch (op) {
    case PickleOp::kGlobal: {
      TRY_ASSIGN(const auto module, take_line());
      TRY_ASSIGN(const auto name, take_line());
      done = push_global(module, name);
      break;
    }
    case PickleOp::kStackGlobal: {
      TRY_ASSIGN(const auto name, pop());
      TRY_ASSIGN(const auto module, pop());
      if (node(name).kind != Kind::kText || node(module).kind != Kind::kText) {
        return fault("the pickle has a function name that is not a string");
      }
      done = push_global(node(module).text, node(name).text);
      break;
    }
    case PickleOp::kReduce:
    case PickleOp::kNewObj:
      done = call();
      break;
    case PickleOp::kBuild:
      done = build();
      break;
    case PickleOp::kBinPersId:
      if (dialect_ != Dialect::kTorch) return false;
      done = refer_to_storage();
      break;
    default:
      return false;
  }
  TRY(std::move(done));
  return true;
}

namespace {

// Opcodes that motion files do not need: old text forms, persistent ids, sets, objects.
constexpr std::array<std::pair<std::uint8_t, const char*>, 24> kRefused = {{
    {'0', "POP"},
    {'1', "POP_MARK"},
    {'2', "DUP"},
    {'F', "FLOAT"},
    {'I', "INT"},
    {'L', "LONG"},
    {'P', "PERSID"},
    {'Q', "BINPERSID"},
    {'S', "STRING"},
    {'V', "UNICODE"},
    {'g', "GET"},
    {'i', "INST"},
    {'o', "OBJ"},
    {'p', "PUT"},
    {0x82, "EXT1"},
    {0x83, "EXT2"},
    {0x84, "EXT4"},
    {0x8f, "EMPTY_SET"},
    {0x90, "ADDITEMS"},
    {0x91, "FROZENSET"},
    {0x92, "NEWOBJ_EX"},
    {0x97, "NEXT_BUFFER"},
    {0x98, "READONLY_BUFFER"},
    {0x8b, "LONG4"},
}};

// Name of an unsupported opcode such as `PERSID`; `0x07` for an unknown byte.
std::string refused_opcode_name(std::uint8_t opcode) {
  for (const auto& [code, name] : kRefused) {
    if (code == opcode) return name;
  }
  return "0x" + hex_text(std::string(1, static_cast<char>(opcode)));
}

}  // namespace

Result<void> PickleReader::read() {
  for (;;) {
    opcode_at_ = at_;
    TRY_ASSIGN(const auto byte, take(1));
    const auto op = static_cast<PickleOp>(static_cast<unsigned char>(byte.front()));
    if (op == PickleOp::kStop) break;
    if (op == PickleOp::kProto || op == PickleOp::kFrame) {
      // A frame only gives the size for read-ahead.
      TRY_ASSIGN(const auto argument, take_size(op == PickleOp::kProto ? 1 : 8));
      if (op == PickleOp::kProto && (argument < 2 || argument > 5)) {
        return fault("the pickle has protocol " + std::to_string(argument) +
                     "; 2 to 5 are supported");
      }
      continue;
    }
    bool known = false;
    for (const auto group :
         {&PickleReader::read_plain, &PickleReader::read_bytes, &PickleReader::read_container,
          &PickleReader::read_memo, &PickleReader::read_object}) {
      TRY_ASSIGN(const auto done, (this->*group)(op));
      known = done;
      if (known) break;
    }
    if (!known) {
      const std::string name = refused_opcode_name(static_cast<std::uint8_t>(op));
      is_damaged_ = name.starts_with("0x");
      return fault("the pickle has the opcode " + name + ", which is not allowed",
                   "only plain values and NumPy arrays are read, and nothing is executed");
    }
  }
  TRY_ASSIGN(const auto root, pop());
  document_.root_ = root;
  return {};
}

}  // namespace retarget
