#include "formats/containers/torch_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "support/torch_builder.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using View = TorchBuilder::View;

Result<NpyArray> read_root(const std::string& bytes, const TorchReadOptions& options = {}) {
  const auto file = TorchFile::open(bytes, "x.pt", options);
  if (!file) return failure(file.error());
  const PickleNode& root = file->document().root();
  EXPECT_EQ(root.kind, PickleNode::Kind::kTensor);
  return file->read(root, "root");
}

std::vector<double> numbers_of(const std::string& bytes) {
  const auto array = read_root(bytes);
  if (array) return array->numbers();
  ADD_FAILURE() << describe(array.error());
  return {};
}

// One sentence about the file, and a hint.
std::string torch_error(const std::string& bytes, const TorchReadOptions& options = {}) {
  const auto array = read_root(bytes, options);
  if (array) return "no error";
  EXPECT_EQ(array.error().kind, ErrorKind::kInput);
  EXPECT_EQ(array.error().location.file, "x.pt");
  EXPECT_EQ(array.error().message.find('\n'), std::string::npos);
  return describe(array.error());
}

std::string storage_of(const std::string& type, const std::string& bytes, std::int64_t count) {
  TorchBuilder builder;
  const std::string storage = builder.storage(type, bytes, count);
  return builder.build(TorchBuilder::rebuilt(storage, {{count}, 0, {}}));
}

std::string one_to_six(const View& view) {
  TorchBuilder builder;
  const std::vector<float> values = {1, 2, 3, 4, 5, 6};
  return builder.build(
      TorchBuilder::rebuilt(builder.storage("FloatStorage", element_bytes(values), 6), view));
}

TEST(TorchFileTest, ReadsEveryTypeOfNumber) {
  const auto one = [](const char* type, const std::string& bytes) {
    return numbers_of(storage_of(type, bytes, 2));
  };
  EXPECT_THAT(one("DoubleStorage", element_bytes<double>({0.1, -2})), ElementsAre(0.1, -2.0));
  EXPECT_THAT(one("FloatStorage", element_bytes<float>({0.5F, -2})), ElementsAre(0.5, -2.0));
  EXPECT_THAT(one("HalfStorage", element_bytes<std::uint16_t>({0x3C00, 0xC100})),
              ElementsAre(1.0, -2.5));
  EXPECT_THAT(one("BFloat16Storage", element_bytes<std::uint16_t>({0x3F80, 0xC020})),
              ElementsAre(1.0, -2.5));
  EXPECT_THAT(one("LongStorage", element_bytes<std::int64_t>({7, -8})), ElementsAre(7.0, -8.0));
  EXPECT_THAT(one("IntStorage", element_bytes<std::int32_t>({7, -8})), ElementsAre(7.0, -8.0));
  EXPECT_THAT(one("ShortStorage", element_bytes<std::int16_t>({7, -8})), ElementsAre(7.0, -8.0));
  EXPECT_THAT(one("CharStorage", element_bytes<std::int8_t>({7, -8})), ElementsAre(7.0, -8.0));
  EXPECT_THAT(one("ByteStorage", "\x07\xF8"), ElementsAre(7.0, 248.0));
  EXPECT_THAT(one("BoolStorage", std::string("\x01\x00", 2)), ElementsAre(1.0, 0.0));
}

TEST(TorchFileTest, ReadsTheOtherByteOrder) {
  for (const auto& [type, bytes] : {std::pair("FloatStorage", std::string("\xC0\x20\x00\x00", 4)),
                                    std::pair("BFloat16Storage", std::string("\xC0\x20", 2))}) {
    TorchBuilder builder;
    builder.byte_order = "big";
    const std::string storage = builder.storage(type, bytes, 1);
    EXPECT_THAT(numbers_of(builder.build(TorchBuilder::rebuilt(storage, {{1}, 0, {}}))),
                ElementsAre(-2.5));
  }
}

TEST(TorchFileTest, ReadsViews) {
  EXPECT_THAT(numbers_of(one_to_six({{2, 3}, 0, {}})), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(numbers_of(one_to_six({{2, 3}, 0, {1, 2}})), ElementsAre(1, 3, 5, 2, 4, 6));
  EXPECT_THAT(numbers_of(one_to_six({{2, 2}, 1, {3, 1}})), ElementsAre(2, 3, 5, 6));
  EXPECT_THAT(numbers_of(one_to_six({{3, 2}, 4, {0, 1}})), ElementsAre(5, 6, 5, 6, 5, 6));
  EXPECT_THAT(numbers_of(one_to_six({{}, 5, {}})), ElementsAre(6));
  EXPECT_THAT(numbers_of(one_to_six({{0, 3}, 6, {}})), ElementsAre());
  const auto array = value_of(read_root(one_to_six({{3, 2}, 0, {}})));
  EXPECT_THAT(array.shape, ElementsAre(3, 2));
}

TEST(TorchFileTest, ReadsPackedStoragesAndPlainValues) {
  TorchBuilder builder;
  builder.style.compress = true;
  const std::string parameter =
      TorchBuilder::call(TorchBuilder::global("torch._utils", "_rebuild_parameter"),
                         {builder.floats({2}, {1, 2}), "\x88", "N"});
  const std::string size =
      TorchBuilder::call(TorchBuilder::global("torch", "Size"), {TorchBuilder::tuple({"K\x03"})});
  const std::string device =
      TorchBuilder::call(TorchBuilder::global("torch", "device"), {TorchBuilder::text("cpu")});
  const std::string bytes = builder.build(TorchBuilder::dictionary(
      {{"weight", parameter}, {"size", size}, {"device", device}, {"fps", "K\x1e"}}));
  const auto file = value_of(TorchFile::open(bytes, "x.pt"));
  const PickleDocument& document = file.document();
  const PickleNode& root = document.root();
  EXPECT_THAT(document.keys(root), ElementsAre("weight", "size", "device", "fps"));
  const auto weight = value_of(file.read(*document.find(root, "weight"), "weight"));
  EXPECT_THAT(weight.numbers(), ElementsAre(1, 2));
  EXPECT_EQ(document.find(root, "device")->text, "cpu");
  EXPECT_EQ(document.number(*document.find(root, "fps")), 30.0);
}

TEST(TorchFileTest, ExecutesNothing) {
  const auto with = [](const std::string& root) { return torch_error(TorchBuilder().build(root)); };
  const std::string system =
      TorchBuilder::call(TorchBuilder::global("os", "system"), {TorchBuilder::text("touch x")});
  EXPECT_THAT(with(system), HasSubstr("names os.system, which is not allowed"));
  EXPECT_THAT(with(system), HasSubstr("nothing is executed"));
  EXPECT_THAT(with(TorchBuilder::dictionary({{"poses", system}})), HasSubstr("os.system"));
  EXPECT_THAT(with(TorchBuilder::global("torch", "load")), HasSubstr("names torch.load"));
  EXPECT_THAT(with(TorchBuilder::global("__main__", "Net")), HasSubstr("names __main__.Net"));
  EXPECT_THAT(with("\x82\x01"), HasSubstr("opcode EXT1"));
  // A plain pickle still rejects persistent identifiers.
  const auto plain = read_pickle("\x80\x02K\x01Q.", "x.pkl");
  ASSERT_FALSE(plain.has_value());
  EXPECT_THAT(plain.error().message, HasSubstr("opcode BINPERSID, which is not allowed"));
}

TEST(TorchFileTest, RejectsViewsBeyondTheirStorage) {
  for (const View& view :
       {View{{7}, 0, {}}, View{{2, 3}, 1, {}}, View{{2}, 0, {6}}, View{{1}, 6, {}},
        View{{1}, INT64_MAX, {}}, View{{3}, 0, {INT64_MAX}},
        View{{3, 3}, 0, {INT64_MAX, INT64_MAX}}, View{{INT64_MAX, 1}, 0, {1, 1}}}) {
    EXPECT_THAT(torch_error(one_to_six(view)), HasSubstr("exceeds its storage of 6 numbers"));
  }
  EXPECT_THAT(torch_error(one_to_six({{-1}, 0, {}})), HasSubstr("without a shape or strides"));
  EXPECT_THAT(torch_error(one_to_six({{2}, 0, {-1}})), HasSubstr("without a shape or strides"));
  EXPECT_THAT(torch_error(one_to_six({{2}, -1, {}})), HasSubstr("in an unsupported way"));
  EXPECT_THAT(torch_error(one_to_six({{2, 3}, 0, {1}})), HasSubstr("do not match its shape"));
  EXPECT_THAT(torch_error(one_to_six({std::vector<std::int64_t>(9, 1), 0, {}})),
              HasSubstr("without a shape or strides"));
}

TEST(TorchFileTest, ChecksAllClaimedSizes) {
  TorchBuilder missing;
  const std::string root = missing.floats({2}, {1, 2});
  missing.forget(0);
  EXPECT_THAT(torch_error(missing.build(root)), HasSubstr("\"data/0\" is not in the archive"));
  EXPECT_THAT(torch_error(storage_of("FloatStorage", "1234", 2)),
              HasSubstr("should have 2 numbers of 4 bytes, found 4 bytes"));
  EXPECT_THAT(torch_error(storage_of("FloatStorage", "12345", 1)), HasSubstr("found 5 bytes"));
  const std::int64_t huge = std::int64_t{1} << 60;
  EXPECT_THAT(torch_error(storage_of("FloatStorage", "1234", huge)), HasSubstr("found 4 bytes"));
  EXPECT_THAT(torch_error(storage_of("DoubleStorage", "1234", INT64_MAX)),
              HasSubstr("too many elements"));
  // One number, repeated.
  EXPECT_THAT(torch_error(one_to_six({{huge, 1}, 0, {0, 1}})),
              HasSubstr("of memory, but its storage"));
  EXPECT_THAT(torch_error(one_to_six({{1 << 22}, 0, {0}})),
              HasSubstr("of memory, but its storage"));
  TorchReadOptions small;
  small.max_number_bytes = 47;
  EXPECT_THAT(torch_error(one_to_six({{6}, 0, {}}), small), HasSubstr("6 numbers need 48 bytes"));
  // Highly compressed zeros.
  TorchBuilder bomb;
  bomb.style.compress = true;
  const std::vector<float> zeros(std::size_t{5} << 20);
  EXPECT_THAT(torch_error(bomb.build(bomb.floats({5 << 20}, zeros))), HasSubstr("need"));
  TorchBuilder unseen;
  unseen.style.compress = true;
  const std::string storage = unseen.storage(
      "ByteStorage", std::string(std::size_t{20} << 20, '\0'), std::int64_t{20} << 20);
  EXPECT_THAT(torch_error(unseen.build(TorchBuilder::rebuilt(storage, {{1}, 0, {}}))),
              HasSubstr("would be unpacked from"));
  TorchBuilder wrong;
  wrong.style.crc_error = 1;
  EXPECT_THAT(torch_error(wrong.build(wrong.floats({1}, {1}))), HasSubstr("its checksum"));
}

TEST(TorchFileTest, RejectsReferencesToOtherValues) {
  const auto with = [](const std::string& id) {
    return torch_error(TorchBuilder().build(id + "Q"));
  };
  const std::string of_numbers = "refers to a value that is not a number storage";
  EXPECT_THAT(with(TorchBuilder::text("storage")), HasSubstr(of_numbers));
  EXPECT_THAT(with(TorchBuilder::tuple({TorchBuilder::text("module")})), HasSubstr(of_numbers));
  const auto storage = [](const std::string& type, std::int64_t count) {
    return TorchBuilder::tuple({TorchBuilder::text("storage"), type, TorchBuilder::text("0"),
                                TorchBuilder::text("cpu"), TorchBuilder::integer(count)});
  };
  EXPECT_THAT(with(storage("N", 1)), HasSubstr(of_numbers));
  EXPECT_THAT(with(storage(TorchBuilder::global("torch", "FloatStorage"), -1)),
              HasSubstr(of_numbers));
  EXPECT_THAT(with(storage(TorchBuilder::global("torch", "ComplexFloatStorage"), 1)),
              HasSubstr("names torch.ComplexFloatStorage, which is not allowed"));
}

TEST(TorchFileTest, RecognisesItsFiles) {
  const std::string bytes = one_to_six({{6}, 0, {}});
  EXPECT_TRUE(is_torch_file(bytes));
  EXPECT_TRUE(is_torch_file(bytes.substr(0, 200)));
  EXPECT_FALSE(is_torch_file("PK\x03\x04"));
  EXPECT_FALSE(is_torch_file(NpzBuilder().add("poses", npy_doubles({1}, {1})).build()));
  EXPECT_TRUE(is_old_torch_file("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19.\x80"));
  EXPECT_FALSE(is_old_torch_file("\x80\x02}q."));

  NpzBuilder program;
  program.add_entry("net/data.pkl", "\x80\x02N.", {}).add_entry("net/code/net.py", "pass", {});
  EXPECT_THAT(torch_error(program.build()), HasSubstr("a TorchScript program"));
  NpzBuilder twice;
  twice.add_entry("net/data.pkl", "\x80\x02N.", {}).add_entry("net/data.pkl", "\x80\x02N.", {});
  EXPECT_THAT(torch_error(twice.build()), HasSubstr("two entries \"net/data.pkl\""));
}

TEST(TorchFileTest, ReadsOrRejectsEveryTruncationAndChange) {
  const std::string bytes = one_to_six({{2, 3}, 0, {1, 2}});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(TorchFile::open(bytes.substr(0, size), "x.pt").has_value());
  }
  EXPECT_THAT(torch_error(bytes.substr(0, 300)), HasSubstr("the file was cut off"));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(~changed[at]);
    const auto file = TorchFile::open(changed, "x.pt");
    if (!file || file->document().root().kind != PickleNode::Kind::kTensor) continue;
    (void)file->read(file->document().root(), "root");
  }
}

}  // namespace
}  // namespace retarget
