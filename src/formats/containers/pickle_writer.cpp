#include "formats/containers/pickle_writer.h"

#include <bit>
#include <limits>
#include <utility>

#include "formats/containers/npz_writer.h"
#include "formats/containers/pickle_opcodes.h"
#include "retarget/bytes.h"
#include "retarget/text.h"

namespace retarget {
PickleWriter::PickleWriter() {
  append_opcode(bytes_, PickleOp::kProto);
  bytes_ += '\x04';
}

void PickleWriter::begin_dict() {
  append_opcode(bytes_, PickleOp::kEmptyDict);
  append_opcode(bytes_, PickleOp::kMark);
}

void PickleWriter::end_dict() {
  append_opcode(bytes_, PickleOp::kSetItems);
}

void PickleWriter::begin_list() {
  append_opcode(bytes_, PickleOp::kEmptyList);
  append_opcode(bytes_, PickleOp::kMark);
}

void PickleWriter::end_list() {
  append_opcode(bytes_, PickleOp::kAppends);
}

void PickleWriter::none() {
  append_opcode(bytes_, PickleOp::kNone);
}

void PickleWriter::integer(std::int64_t value) {
  using Limits = std::numeric_limits<std::int32_t>;
  const bool is_short = value >= Limits::min() && value <= Limits::max();
  append_opcode(bytes_, is_short ? PickleOp::kBinInt : PickleOp::kLong1);
  if (!is_short) bytes_ += '\x08';
  append_little_endian(bytes_, std::bit_cast<std::uint64_t>(value), is_short ? 4 : 8);
}

void PickleWriter::number(double value) {
  append_opcode(bytes_, PickleOp::kBinFloat);
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 7; i >= 0; --i) bytes_ += static_cast<char>(bits >> (8 * i));
}

void PickleWriter::text(std::string_view value) {
  const std::string utf8 = valid_utf8(value);
  const bool is_short = utf8.size() < 256;
  append_opcode(bytes_, is_short ? PickleOp::kShortBinUnicode : PickleOp::kBinUnicode8);
  append_little_endian(bytes_, utf8.size(), is_short ? 1 : 8);
  bytes_ += utf8;
}

void PickleWriter::texts(std::span<const std::string> values) {
  begin_list();
  for (const std::string& value : values) text(value);
  end_list();
}

void PickleWriter::bytes(std::string_view value) {
  const bool is_short = value.size() < 256;
  append_opcode(bytes_, is_short ? PickleOp::kShortBinBytes : PickleOp::kBinBytes8);
  append_little_endian(bytes_, value.size(), is_short ? 1 : 8);
  bytes_ += value;
}

void PickleWriter::tuple_of_lengths(std::span<const std::size_t> lengths) {
  append_opcode(bytes_, PickleOp::kMark);
  for (const std::size_t length : lengths) integer(static_cast<std::int64_t>(length));
  append_opcode(bytes_, PickleOp::kTuple);
}

void PickleWriter::global(std::string_view module, std::string_view name) {
  text(module);
  text(name);
  append_opcode(bytes_, PickleOp::kStackGlobal);
}

void PickleWriter::array(const NpyArray& array) {
  // _reconstruct(ndarray, (0,), b'b')
  global("numpy.core.multiarray", "_reconstruct");
  global("numpy", "ndarray");
  integer(0);
  append_opcode(bytes_, PickleOp::kTuple1);
  bytes("b");
  append_opcode(bytes_, PickleOp::kTuple3);
  append_opcode(bytes_, PickleOp::kReduce);
  // State: version, shape, dtype, is Fortran order, elements.
  append_opcode(bytes_, PickleOp::kMark);
  integer(1);
  tuple_of_lengths(array.shape);
  const std::string type = npy_type_text(array);
  global("numpy", "dtype");
  text(std::string_view(type).substr(1));
  append_opcode(bytes_, PickleOp::kNewFalse);
  append_opcode(bytes_, PickleOp::kNewTrue);
  append_opcode(bytes_, PickleOp::kTuple3);
  append_opcode(bytes_, PickleOp::kReduce);
  append_opcode(bytes_, PickleOp::kMark);
  integer(3);
  text(std::string_view(type).substr(0, 1));
  for (int i = 0; i < 3; ++i) none();
  integer(-1);
  integer(-1);
  integer(0);
  append_opcode(bytes_, PickleOp::kTuple);
  append_opcode(bytes_, PickleOp::kBuild);
  append_opcode(bytes_, PickleOp::kNewFalse);
  bytes(array.data);
  append_opcode(bytes_, PickleOp::kTuple);
  append_opcode(bytes_, PickleOp::kBuild);
}

std::string PickleWriter::finish() {
  append_opcode(bytes_, PickleOp::kStop);
  return std::move(bytes_);
}

}  // namespace retarget
