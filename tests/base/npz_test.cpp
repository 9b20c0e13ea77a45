#include "formats/containers/npz.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/npz_arrays.h"
#include "support/npz_builder.h"
#include "support/read_npy.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Style = NpzBuilder::Style;

std::string reversed_items(std::string bytes, std::size_t size) {
  for (std::size_t at = 0; at < bytes.size(); at += size) {
    std::reverse(bytes.begin() + at, bytes.begin() + at + size);
  }
  return bytes;
}

TEST(Npz, ListsAndReadsArrays) {
  const std::string bytes = NpzBuilder()
                                .add("trans", npy_doubles({2, 3}, {1, 2, 3, 4, 5, 6}))
                                .add("fps", npy("<i8", "()", element_bytes<std::int64_t>({30})))
                                .build();
  const auto file = value_of(NpzFile::open(bytes, "a.npz"));
  EXPECT_THAT(file.names(), ElementsAre("trans", "fps"));
  EXPECT_TRUE(file.has("fps"));
  EXPECT_FALSE(file.has("trans.npy"));

  const auto trans = value_of(file.read("trans"));
  EXPECT_THAT(trans.shape, ElementsAre(2, 3));
  EXPECT_THAT(trans.numbers(), ElementsAre(1, 2, 3, 4, 5, 6));
  const auto fps = value_of(file.read("fps"));
  EXPECT_THAT(fps.shape, IsEmpty());
  EXPECT_EQ(fps.element_count(), 1U);
  EXPECT_THAT(fps.numbers(), ElementsAre(30));
  EXPECT_EQ(*file.type_of("trans"), "<f8");
}

TEST(Npz, EveryStorageMethodGivesTheSameArray) {
  const std::string array = npy_doubles({3}, {0.5, -2, 7});
  for (const bool compress : {false, true}) {
    for (const bool zip64_local : {false, true}) {
      for (const bool zip64_central : {false, true}) {
        for (const bool data_descriptor : {false, true}) {
          Style style;
          style.compress = compress;
          style.zip64_local = zip64_local;
          style.zip64_central = zip64_central;
          style.data_descriptor = data_descriptor;
          EXPECT_THAT(array_of(array, style).numbers(), ElementsAre(0.5, -2, 7));
        }
      }
    }
  }
}

TEST(Npz, FindsTheDirectoryWithZip64AndComments) {
  const NpzBuilder builder = NpzBuilder().add("a", npy_doubles({1}, {4}));
  for (const bool zip64 : {false, true}) {
    for (const std::string& comment :
         {std::string(), std::string("PK\x05\x06 not the end"), std::string(65535, 'x')}) {
      const auto array = value_of(read_array(builder.build(zip64, comment), "a"));
      EXPECT_THAT(array.numbers(), ElementsAre(4));
    }
  }
}

TEST(Npz, AcceptsFilesWithoutArrays) {
  const std::string bytes = NpzBuilder().build();
  const auto file = value_of(NpzFile::open(bytes, "a.npz"));
  EXPECT_THAT(file.names(), IsEmpty());
  EXPECT_THAT(error_of(file.read("a")), HasSubstr("no array \"a\"; found no arrays at all"));
}

TEST(Npz, ReadsEveryKindOfNumberInEitherByteOrder) {
  const auto both = [](const std::string& type, std::size_t size, const std::string& data) {
    const NpyArray little = array_of(npy("<" + type, "(3,)", data));
    const NpyArray big = array_of(npy(">" + type, "(3,)", reversed_items(data, size)));
    EXPECT_EQ(little.data, big.data) << type;
    return little.numbers();
  };
  EXPECT_THAT(both("i1", 1, element_bytes<std::int8_t>({-128, 0, 127})), ElementsAre(-128, 0, 127));
  EXPECT_THAT(both("i2", 2, element_bytes<std::int16_t>({-32768, 1, 32767})),
              ElementsAre(-32768, 1, 32767));
  EXPECT_THAT(both("i4", 4, element_bytes<std::int32_t>({-2147483647, 5, 2147483647})),
              ElementsAre(-2147483647, 5, 2147483647));
  EXPECT_THAT(both("i8", 8, element_bytes<std::int64_t>({-9007199254740992, 6, 1})),
              ElementsAre(-9007199254740992.0, 6, 1));
  EXPECT_THAT(both("u1", 1, element_bytes<std::uint8_t>({0, 128, 255})), ElementsAre(0, 128, 255));
  EXPECT_THAT(both("u2", 2, element_bytes<std::uint16_t>({0, 258, 65535})),
              ElementsAre(0, 258, 65535));
  EXPECT_THAT(both("u4", 4, element_bytes<std::uint32_t>({0, 16909060, 4294967295})),
              ElementsAre(0, 16909060, 4294967295.0));
  EXPECT_THAT(both("u8", 8, element_bytes<std::uint64_t>({0, 7, 1ULL << 63})),
              ElementsAre(0, 7, 9223372036854775808.0));
  EXPECT_THAT(both("f4", 4, element_bytes<float>({-1.5F, 3e38F, 1e-45F})),
              ElementsAre(-1.5, static_cast<double>(3e38F), static_cast<double>(1e-45F)));
  EXPECT_THAT(both("f8", 8, element_bytes<double>({0.1, -1e308, 5e-324})),
              ElementsAre(0.1, -1e308, 5e-324));
  EXPECT_THAT(array_of(npy("|b1", "(3,)", std::string("\0\1\1", 3))).numbers(),
              ElementsAre(0, 1, 1));
}

TEST(Npz, ReadsHalfFloats) {
  // One, minus two, largest, smallest normal, smallest subnormal, a third.
  const std::string data =
      element_bytes<std::uint16_t>({0x3C00, 0xC000, 0x7BFF, 0x0400, 0x0001, 0x3555});
  EXPECT_THAT(
      array_of(npy("<f2", "(6,)", data)).numbers(),
      ElementsAre(1, -2, 65504, std::ldexp(1.0, -14), std::ldexp(1.0, -24), 1365.0 / 4096.0));
  const auto special =
      array_of(npy("<f2", "(3,)", element_bytes<std::uint16_t>({0x7C00, 0xFC00, 0x7E00})))
          .numbers();
  EXPECT_EQ(special[0], HUGE_VAL);
  EXPECT_EQ(special[1], -HUGE_VAL);
  EXPECT_TRUE(std::isnan(special[2]));
}

TEST(Npz, ReadsText) {
  std::string characters;
  for (const std::uint32_t c : {0x6D, 0x61, 0, 0xE9, 0x20AC, 0x1F600, 0xD800, 0, 0}) {
    characters += little_endian_bytes(c, 4);
  }
  const std::vector<std::string> expected = {
      std::string("ma"), "\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80", "\xEF\xBF\xBD"};
  EXPECT_EQ(array_of(npy("<U3", "(3,)", characters)).texts(), expected);
  EXPECT_EQ(array_of(npy(">U3", "(3,)", reversed_items(characters, 4))).texts(), expected);
  EXPECT_THAT(array_of(npy("|S6", "(2,)", std::string("male\0\0female", 12))).texts(),
              ElementsAre("male", "female"));
  EXPECT_THAT(array_of(npy_text("neutral")).texts(), ElementsAre("neutral"));
}

TEST(Npz, ConvertsFortranOrder) {
  // Element (i, j, k) is 100 i + 10 j + k; the first index varies fastest in the file.
  std::vector<double> fortran, c_order;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 2; ++i) fortran.push_back(100 * i + 10 * j + k);
    }
  }
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 4; ++k) c_order.push_back(100 * i + 10 * j + k);
    }
  }
  const std::string bytes = npy("<f8", "(2, 3, 4)", element_bytes(fortran), true);
  EXPECT_EQ(array_of(bytes).numbers(), c_order);
  EXPECT_THAT(array_of(npy("<f8", "(2,)", element_bytes<double>({1, 2}), true)).numbers(),
              ElementsAre(1, 2));
  EXPECT_THAT(array_of(npy("<f8", "(2, 0)", "", true)).numbers(), IsEmpty());
}

TEST(Npz, ReadsEmptyArrays) {
  EXPECT_THAT(array_of(npy("<f4", "(0,)", "")).shape, ElementsAre(0));
  EXPECT_THAT(array_of(npy("<f4", "(0, 3)", "")).numbers(), IsEmpty());
  EXPECT_EQ(array_of(npy("<f4", "(99999999999, 0)", "")).element_count(), 0U);
}

TEST(Npz, ReadsHeadersOfEveryVersionAndSpelling) {
  const std::string data = element_bytes<double>({1, 2});
  for (const int version : {1, 2, 3}) {
    EXPECT_THAT(array_of(npy("<f8", "(2,)", data, false, version)).numbers(), ElementsAre(1, 2));
  }
  for (const std::string dictionary : {
           R"({"shape": (2,), "fortran_order": False, "descr": "<f8"})",
           R"( { 'fortran_order' :False,'shape':( 2 , ),'descr':'<f8' , } )",
           R"({'descr': '<f8', 'fortran_order': False, 'shape': (2L,), })",
       }) {
    EXPECT_THAT(array_of(npy_with_header(dictionary, data)).numbers(), ElementsAre(1, 2))
        << dictionary;
  }
}

TEST(Npz, RejectsMalformedHeaders) {
  const std::string data = element_bytes<double>({1, 2});
  for (const std::string dictionary : {
           "",
           "{",
           "{}",
           "'descr'",
           "{'descr': '<f8', 'fortran_order': False}",
           "{'descr': '<f8', 'fortran_order': 0, 'shape': (2,)}",
           "{'descr': '<f8', 'fortran_order': False, 'shape': 2}",
           "{'descr': '<f8', 'fortran_order': False, 'shape': (-2,)}",
           "{'descr': '<f8', 'fortran_order': False, 'shape': (2}",
           "{'descr': '<f8', 'fortran_order': False, 'shape': (2,)",
           "{'descr': '<f8', 'fortran_order': False, 'shape': (2,)} x",
           "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999,)}",
           "{'descr: <f8}",
           "{'descr': [('a', '<f8'",
           "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), 'other': 1}",
       }) {
    EXPECT_THAT(array_error(npy_with_header(dictionary, data)),
                HasSubstr("a.npz: error: array \"a\": the NPY header"))
        << dictionary;
  }
  EXPECT_THAT(array_error(npy("<f8", "(2,)", data, false, 4)),
              HasSubstr("expected NPY version 1, 2 or 3, found 4"));
  EXPECT_THAT(array_error("no array at all"), HasSubstr("expected an NPY array"));
  EXPECT_THAT(array_error("\x93NUMPY"), HasSubstr("is truncated"));
  EXPECT_THAT(array_error("\x93NUMPY\x02" + std::string(1, '\0') + "\xff\xff\xff\xff{"),
              HasSubstr("header has 4294967295 bytes"));
}

TEST(Npz, RejectsPythonObjects) {
  const std::string bytes = NpzBuilder().add("gender", npy("|O", "()", "\x80\x04\x4e.")).build();
  const auto file = value_of(NpzFile::open(bytes, "a.npz"));
  EXPECT_EQ(*file.type_of("gender"), "|O");
  const Result<NpyArray> array = file.read("gender");
  EXPECT_THAT(error_of(array), HasSubstr("array \"gender\": it contains Python objects"));
  EXPECT_THAT(error_of(array), HasSubstr("hint: unpickling can run code"));
  EXPECT_EQ(array.error().kind, ErrorKind::kInput);
}

TEST(Npz, RejectsUnknownTypes) {
  for (const std::string type : {"<c8", "<f16", "<f1", "<i3", "<M8[ns]", "|V4", "<U0", "|S0", "f8",
                                 "", "<", "<f", "<f8x", "<U99999999999999999999", "|b2"}) {
    EXPECT_THAT(array_error(npy(type, "()", "12345678")),
                HasSubstr("array \"a\": its type " + type + " is not supported"));
  }
  EXPECT_THAT(array_error(npy_with_header("{'descr': [('x', '<f4'), ('y', '<f4', (2, 2))], "
                                          "'fortran_order': False, 'shape': ()}",
                                          "12345678")),
              HasSubstr("its type [...] is not supported"));
}

TEST(Npz, ChecksTheShapeAgainstTheData) {
  const std::string data = element_bytes<double>({1, 2});
  EXPECT_THAT(array_error(npy("<f8", "(3,)", data)),
              HasSubstr("its shape (3,) of <f8 needs 24 bytes, found 16"));
  EXPECT_THAT(array_error(npy("<f8", "(1,)", data)), HasSubstr("needs 8 bytes, found 16"));
  EXPECT_THAT(array_error(npy("<f8", "(4294967296, 4294967296)", data)),
              HasSubstr("too many elements"));
  EXPECT_THAT(array_error(npy("<f8", "(2305843009213693952,)", data)),
              HasSubstr("too many elements"));
  EXPECT_THAT(array_error(npy("<f8", "(1000000000000,)", data)),
              HasSubstr("needs 8000000000000 bytes, found 16"));
}

TEST(Npz, VerifiesTheChecksum) {
  for (const bool compress : {false, true}) {
    Style style;
    style.compress = compress;
    style.crc_error = 1;
    EXPECT_THAT(array_error(npy_doubles({1}, {3}), style),
                HasSubstr("array \"a\": its checksum does not match"));
  }
}

TEST(Npz, RejectsUnsupportedCompression) {
  Style style;
  style.flags = 1;
  EXPECT_THAT(array_error(npy_doubles({1}, {3}), style), HasSubstr("it is encrypted"));
  style.flags = 0;
  style.method = 14;
  EXPECT_THAT(array_error(npy_doubles({1}, {3}), style),
              HasSubstr("its compression (ZIP method 14) is not supported"));
  style.method = 8;
  EXPECT_THAT(array_error(npy_doubles({1}, {3}), style), HasSubstr("array \"a\": "));
}

TEST(Npz, RejectsDuplicateNames) {
  const std::string bytes = NpzBuilder()
                                .add("a", npy_doubles({1}, {1}))
                                .add_entry("a", npy_doubles({1}, {2}), {})
                                .build();
  EXPECT_THAT(error_of(NpzFile::open(bytes, "a.npz")), HasSubstr("there are two arrays \"a\""));
}

TEST(Npz, ListsArraysIfOneIsMissing) {
  const std::string bytes =
      NpzBuilder().add("poses", npy_doubles({1}, {1})).add("trans", npy_doubles({1}, {1})).build();
  EXPECT_THAT(error_of(read_array(bytes, "Poses")),
              HasSubstr("no array \"Poses\" (did you mean \"poses\"?); found poses, trans"));
}

TEST(Npz, NamesOtherFileTypes) {
  const auto error = [](const std::string& bytes) {
    return error_of(NpzFile::open(bytes, "walk.npz"));
  };
  EXPECT_THAT(error(""), HasSubstr("walk.npz: error: expected an NPZ file, found an empty file"));
  EXPECT_THAT(error(npy_doubles({1}, {1})), HasSubstr("a single NPY array"));
  EXPECT_THAT(error("\x80\x04\x95"), HasSubstr("a Python pickle"));
  EXPECT_THAT(error("HIERARCHY\n"), HasSubstr("a BVH file"));
  EXPECT_THAT(error("some text that is long enough for a ZIP archive"),
              HasSubstr("no ZIP directory at its end"));
  NpzReadOptions options;
  options.error_kind = ErrorKind::kConfig;
  EXPECT_EQ(NpzFile::open("", "model.npz", options).error().kind, ErrorKind::kConfig);
}

TEST(Npy, ReadsASingleArray) {
  const auto array = value_of(read_npy(npy_floats({2, 1}, {1.5F, -2.0F}), "a.npy"));
  EXPECT_THAT(array.shape, ElementsAre(2, 1));
  EXPECT_THAT(array.numbers(), ElementsAre(1.5, -2.0));
  const std::string whole = npy_floats({2}, {1, 2});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const ExactBytes exact(std::string_view(whole).substr(0, size));
    EXPECT_THAT(error_of(read_npy(exact.view(), "a.npy")), HasSubstr("a.npy: error: "));
  }
}

}  // namespace
}  // namespace retarget
