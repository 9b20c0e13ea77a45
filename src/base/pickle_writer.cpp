#include "base/pickle_writer.h"

#include <bit>
#include <limits>
#include <utility>

#include "base/npz_writer.h"
#include "base/pickle_opcodes.h"
#include "base/utf8.h"

namespace retarget {
namespace {

void put(std::string& bytes, PickleOp op) {
  bytes += static_cast<char>(op);
}

void put_number(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i));
}

}  // namespace

PickleWriter::PickleWriter() {
  put(bytes_, PickleOp::kProto);
  bytes_ += '\x04';
}

void PickleWriter::begin_dict() {
  put(bytes_, PickleOp::kEmptyDict);
  put(bytes_, PickleOp::kMark);
}

void PickleWriter::end_dict() {
  put(bytes_, PickleOp::kSetItems);
}

void PickleWriter::none() {
  put(bytes_, PickleOp::kNone);
}

void PickleWriter::integer(std::int64_t value) {
  using Limits = std::numeric_limits<std::int32_t>;
  const bool is_short = value >= Limits::min() && value <= Limits::max();
  put(bytes_, is_short ? PickleOp::kBinInt : PickleOp::kLong1);
  if (!is_short) bytes_ += '\x08';
  put_number(bytes_, std::bit_cast<std::uint64_t>(value), is_short ? 4 : 8);
}

void PickleWriter::number(double value) {
  put(bytes_, PickleOp::kBinFloat);
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 7; i >= 0; --i) bytes_ += static_cast<char>(bits >> (8 * i));
}

void PickleWriter::text(std::string_view value) {
  const std::string utf8 = valid_utf8(value);
  const bool is_short = utf8.size() < 256;
  put(bytes_, is_short ? PickleOp::kShortBinUnicode : PickleOp::kBinUnicode8);
  put_number(bytes_, utf8.size(), is_short ? 1 : 8);
  bytes_ += utf8;
}

void PickleWriter::texts(std::span<const std::string> values) {
  put(bytes_, PickleOp::kEmptyList);
  put(bytes_, PickleOp::kMark);
  for (const std::string& value : values) text(value);
  put(bytes_, PickleOp::kAppends);
}

void PickleWriter::bytes(std::string_view value) {
  const bool is_short = value.size() < 256;
  put(bytes_, is_short ? PickleOp::kShortBinBytes : PickleOp::kBinBytes8);
  put_number(bytes_, value.size(), is_short ? 1 : 8);
  bytes_ += value;
}

void PickleWriter::tuple_of_lengths(std::span<const std::size_t> lengths) {
  put(bytes_, PickleOp::kMark);
  for (const std::size_t length : lengths) integer(static_cast<std::int64_t>(length));
  put(bytes_, PickleOp::kTuple);
}

void PickleWriter::global(std::string_view module, std::string_view name) {
  text(module);
  text(name);
  put(bytes_, PickleOp::kStackGlobal);
}

void PickleWriter::array(const NpyArray& array) {
  // _reconstruct(ndarray, (0,), b'b')
  global("numpy.core.multiarray", "_reconstruct");
  global("numpy", "ndarray");
  integer(0);
  put(bytes_, PickleOp::kTuple1);
  bytes("b");
  put(bytes_, PickleOp::kTuple3);
  put(bytes_, PickleOp::kReduce);
  // its state: version, shape, dtype, no Fortran order, elements
  put(bytes_, PickleOp::kMark);
  integer(1);
  tuple_of_lengths(array.shape);
  const std::string type = npy_type_text(array);
  global("numpy", "dtype");
  text(std::string_view(type).substr(1));
  put(bytes_, PickleOp::kNewFalse);
  put(bytes_, PickleOp::kNewTrue);
  put(bytes_, PickleOp::kTuple3);
  put(bytes_, PickleOp::kReduce);
  put(bytes_, PickleOp::kMark);
  integer(3);
  text(std::string_view(type).substr(0, 1));
  for (int i = 0; i < 3; ++i) none();
  integer(-1);
  integer(-1);
  integer(0);
  put(bytes_, PickleOp::kTuple);
  put(bytes_, PickleOp::kBuild);
  put(bytes_, PickleOp::kNewFalse);
  bytes(array.data);
  put(bytes_, PickleOp::kTuple);
  put(bytes_, PickleOp::kBuild);
}

std::string PickleWriter::finish() {
  put(bytes_, PickleOp::kStop);
  return std::move(bytes_);
}

}  // namespace retarget
