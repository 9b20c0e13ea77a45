#include "formats/containers/torch_writer.h"

#include <bit>
#include <limits>
#include <utility>

#include "formats/containers/pickle_opcodes.h"
#include "formats/containers/zip_writer.h"
#include "retarget/bytes.h"
#include "retarget/text.h"

namespace retarget {
namespace {

std::string_view storage_name(const NpyArray& array) {
  if (array.kind == NpyKind::kBool) return "BoolStorage";
  if (array.kind == NpyKind::kSigned) return "LongStorage";
  return array.item_size == 4 ? "FloatStorage" : "DoubleStorage";
}

}  // namespace

TorchWriter::TorchWriter() {
  append_opcode(pickle_, PickleOp::kProto);
  pickle_ += '\x02';
  append_opcode(pickle_, PickleOp::kEmptyDict);
  append_opcode(pickle_, PickleOp::kMark);
}

void TorchWriter::text(std::string_view value) {
  const std::string utf8 = valid_utf8(value);
  append_opcode(pickle_, PickleOp::kBinUnicode);
  append_little_endian(pickle_, utf8.size(), 4);
  pickle_ += utf8;
}

void TorchWriter::whole(std::int64_t value) {
  using Limits = std::numeric_limits<std::int32_t>;
  const bool is_short = value >= Limits::min() && value <= Limits::max();
  append_opcode(pickle_, is_short ? PickleOp::kBinInt : PickleOp::kLong1);
  if (!is_short) pickle_ += '\x08';
  append_little_endian(pickle_, std::bit_cast<std::uint64_t>(value), is_short ? 4 : 8);
}

void TorchWriter::tuple_of(const std::vector<std::size_t>& sizes) {
  append_opcode(pickle_, PickleOp::kMark);
  for (const std::size_t size : sizes) whole(static_cast<std::int64_t>(size));
  append_opcode(pickle_, PickleOp::kTuple);
}

void TorchWriter::global(std::string_view module, std::string_view name) {
  append_opcode(pickle_, PickleOp::kGlobal);
  pickle_ += module;
  pickle_ += '\n';
  pickle_ += name;
  pickle_ += '\n';
}

void TorchWriter::integer(std::string_view key, std::int64_t value) {
  text(key);
  whole(value);
}

void TorchWriter::number(std::string_view key, double value) {
  text(key);
  append_opcode(pickle_, PickleOp::kBinFloat);
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 7; i >= 0; --i) pickle_ += static_cast<char>(bits >> (8 * i));
}

void TorchWriter::tensor(std::string_view key, const NpyArray& array) {
  text(key);
  global("torch._utils", "_rebuild_tensor_v2");
  append_opcode(pickle_, PickleOp::kMark);
  // The storage: ('storage', class, key, device, element count).
  append_opcode(pickle_, PickleOp::kMark);
  text("storage");
  global("torch", storage_name(array));
  text(std::to_string(storages_.size()));
  text("cpu");
  whole(static_cast<std::int64_t>(array.element_count()));
  append_opcode(pickle_, PickleOp::kTuple);
  append_opcode(pickle_, PickleOp::kBinPersId);
  whole(0);  // Offset.
  tuple_of(array.shape);
  std::vector<std::size_t> strides(array.shape.size(), 1);
  for (std::size_t i = strides.size(); i-- > 1;) strides[i - 1] = strides[i] * array.shape[i];
  tuple_of(strides);
  append_opcode(pickle_, PickleOp::kNewFalse);  // requires_grad
  global("collections", "OrderedDict");
  append_opcode(pickle_, PickleOp::kEmptyTuple);
  append_opcode(pickle_, PickleOp::kReduce);
  append_opcode(pickle_, PickleOp::kTuple);
  append_opcode(pickle_, PickleOp::kReduce);
  storages_.push_back(array.data);
}

void TorchWriter::enum_member(std::string_view key, std::string_view module, std::string_view name,
                              std::string_view value) {
  text(key);
  global(module, name);
  text(value);
  append_opcode(pickle_, PickleOp::kTuple1);
  append_opcode(pickle_, PickleOp::kReduce);
}

Result<std::string> TorchWriter::finish(std::string_view folder) {
  append_opcode(pickle_, PickleOp::kSetItems);
  append_opcode(pickle_, PickleOp::kStop);
  const std::string place = std::string(folder) + "/";
  ZipWriter zip;
  zip.add(place + "data.pkl", pickle_);
  zip.add(place + "byteorder", "little");
  for (std::size_t i = 0; i < storages_.size(); ++i) {
    zip.add(place + "data/" + std::to_string(i), storages_[i]);
    storages_[i] = {};
  }
  zip.add(place + "version", "3\n");
  return zip.finish();
}

}  // namespace retarget
