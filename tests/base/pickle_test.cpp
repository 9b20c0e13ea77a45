#include "formats/containers/pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <vector>

#include "formats/containers/npz.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using namespace std::string_literals;
using ::testing::HasSubstr;
using Kind = PickleNode::Kind;

std::string pickle_error(const std::string& bytes) {
  const auto read = read_pickle(bytes, "x.pkl");
  return read ? "no error" : describe(read.error());
}

std::string two_arrays() {
  const std::vector<double> values = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  PickleWriter pickle;
  pickle.begin_dict();
  pickle.text("doubles");
  pickle.array(float64_array(values, {2, 3}));
  pickle.text("floats");
  pickle.array(float32_array(values, {3, 2}));
  pickle.text("fps");
  pickle.integer(30);
  pickle.text("far");
  pickle.integer(-5'000'000'000);
  pickle.text("step");
  pickle.number(-0.125);
  pickle.text("nothing");
  pickle.none();
  const std::vector<std::string> names = {"a", "b"};
  pickle.text("names");
  pickle.texts(names);
  pickle.end_dict();
  return pickle.finish();
}

TEST(PickleTest, RoundTrips) {
  const std::string bytes = two_arrays();
  const auto read = value_of(read_pickle(bytes, "x.pkl"));
  const PickleNode& root = read.root();
  EXPECT_THAT(read.keys(root), ::testing::ElementsAre("doubles", "floats", "fps", "far", "step",
                                                      "nothing", "names"));
  const NpyArray& floats = read.array(*read.find(root, "floats"));
  EXPECT_EQ(floats.item_size, 4U);
  EXPECT_THAT(floats.shape, ::testing::ElementsAre(3, 2));
  EXPECT_THAT(floats.numbers(), ::testing::ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(read.number(*read.find(root, "fps")), 30.0);
  EXPECT_EQ(read.number(*read.find(root, "far")), -5e9);
  EXPECT_EQ(read.number(*read.find(root, "step")), -0.125);
  EXPECT_EQ(read.find(root, "nothing")->kind, Kind::kNone);
  EXPECT_EQ(read.at(read.find(root, "names")->items[1]).text, "b");
  EXPECT_EQ(read.find(root, "other"), nullptr);
}

TEST(PickleTest, EveryTruncationIsAnError) {
  const std::string bytes = two_arrays();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(read_pickle(bytes.substr(0, size), "x.pkl").has_value()) << size;
  }
}

TEST(PickleTest, HandlesEveryChangedByte) {
  const std::string bytes = two_arrays();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const int value : {0, 1, 0x28, 0x52, 0x62, 0x7f, 0xff}) {
      std::string changed = bytes;
      changed[i] = static_cast<char>(value);
      // The reader must neither crash nor hang; the result may still be valid.
      (void)read_pickle(changed, "x.pkl");
    }
  }
}

TEST(PickleTest, NothingIsExecuted) {
  // Calls os.system('id') with GLOBAL and REDUCE.
  EXPECT_THAT(pickle_error("\x80\x02"
                           "cos\nsystem\nX\x02\0\0\0id\x85R."s),
              HasSubstr("the pickle names os.system, which is not allowed (byte 2 of the pickle)"));
  // The same call with STACK_GLOBAL.
  EXPECT_THAT(pickle_error("\x80\x04\x8c\x05posix\x8c\x06system\x93\x8c\x02id\x85R."s),
              HasSubstr("the pickle names posix.system, which is not allowed"));
  EXPECT_THAT(pickle_error("\x80\x02"
                           "c__builtin__\neval\n."s),
              HasSubstr("__builtin__.eval"));
  EXPECT_THAT(pickle_error("\x80\x02"
                           "cnumpy.core.multiarray\nfromfile\n."s),
              HasSubstr("not allowed"));
  EXPECT_THAT(pickle_error("\x80\x02"
                           "ctorch._utils\n_rebuild_tensor_v2\n."s),
              HasSubstr("tensor.cpu().numpy()"));
  // INST and OBJ, the old opcodes for calls.
  EXPECT_THAT(pickle_error("\x80\x02(ios\nsystem\n."s), HasSubstr("the opcode INST"));
  EXPECT_THAT(pickle_error("\x80\x02(o."s), HasSubstr("the opcode OBJ"));
  EXPECT_THAT(pickle_error("\x80\x02Pabc\n."s), HasSubstr("the opcode PERSID"));
  EXPECT_THAT(pickle_error("\x80\x04\x92."s), HasSubstr("the opcode NEWOBJ_EX"));
  EXPECT_THAT(pickle_error("\x80\x02\x82\x01."s), HasSubstr("the opcode EXT1"));
  EXPECT_THAT(pickle_error("\x80\x02\x07."s), HasSubstr("the opcode 0x07"));
}

// Written by Python 2 with protocol 2: {'pose': numpy.array([[1.0, 0.5]]), 'name': 'walk'}.
TEST(PickleTest, ReadsStringsOfPython2) {
  const std::string bytes =
      "\x80\x02}q\x01(U\x04poseq\x02"
      "cnumpy.core.multiarray\n_reconstruct\nq\x03"
      "cnumpy\nndarray\nq\x04K\0\x85U\x01"
      "b\x87Rq\x05(K\x01K\x01K\x02\x86"
      "cnumpy\ndtype\nq\x06U\x02"
      "f8K\0K\x01\x87Rq\x07(K\x03U\x01<NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\0tb\x89"
      "T\x10\0\0\0\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\xe0\x3ftbU\x04nameU\x04walku."s;
  const auto read = value_of(read_pickle(bytes, "x.pkl"));
  EXPECT_THAT(read.array(*read.find(read.root(), "pose")).numbers(),
              ::testing::ElementsAre(1.0, 0.5));
  EXPECT_EQ(read.find(read.root(), "name")->text, "walk");
}

TEST(PickleTest, EscapesControlCharactersInNames) {
  const std::string error = pickle_error("\x80\x04\x8c\x04\x1b[2J\x8c\x01x\x93."s);
  EXPECT_EQ(error.find('\x1b'), std::string::npos) << error;
}

TEST(PickleTest, ClaimedSizesAllocateNothing) {
  EXPECT_THAT(pickle_error("\x80\x03"
                           "B\xff\xff\xff\xff"
                           "abc."s),
              HasSubstr("cut off"));
  EXPECT_THAT(pickle_error("\x80\x04\x8e\xff\xff\xff\xff\xff\xff\xff\x7f"
                           "abc."s),
              HasSubstr("cut off"));
  EXPECT_THAT(pickle_error("\x80\x05\x96\xff\xff\xff\xff\xff\xff\xff\xff"
                           "abc."s),
              HasSubstr("cut off"));
  EXPECT_THAT(pickle_error("\x80\x04\x8d\0\0\0\0\0\0\0\x80"
                           "abc."s),
              HasSubstr("cut off"));
}

TEST(PickleTest, MemoAndStackAreBounded) {
  EXPECT_THAT(pickle_error("\x80\x02h\x05."s), HasSubstr("its value 5, which it never stored"));
  EXPECT_THAT(pickle_error("\x80\x02j\xff\xff\xff\xff."s), HasSubstr("4294967295"));
  EXPECT_THAT(pickle_error("\x80\x02q\x01."s), HasSubstr("never created"));
  EXPECT_THAT(pickle_error("\x80\x02N0."s), HasSubstr("POP"));
  EXPECT_THAT(pickle_error("\x80\x02t."s), HasSubstr("never started"));
  EXPECT_THAT(pickle_error("\x80\x02(N\x85."s), HasSubstr(""));
  EXPECT_THAT(pickle_error("\x80\x02N(s."s), HasSubstr("never created"));
  EXPECT_THAT(pickle_error("\x80\x02."s), HasSubstr("never created"));
  EXPECT_THAT(pickle_error("\x80\x02]]s."s), HasSubstr(""));
  // A large index costs one entry.
  EXPECT_TRUE(read_pickle("\x80\x02Nr\xff\xff\xff\x7f."s, "x.pkl").has_value());
}

TEST(PickleTest, DepthAndCyclesDoNotOverflowTheStack) {
  // A list in a list in a list ..., each appended to the next.
  std::string deep = "\x80\x02";
  for (int i = 0; i < 300000; ++i) deep += ']';
  for (int i = 0; i < 299999; ++i) deep += 'a';
  EXPECT_TRUE(read_pickle(deep + ".", "x.pkl").has_value());
  std::string tuples = "\x80\x02N";
  for (int i = 0; i < 300000; ++i) tuples += '\x85';
  EXPECT_TRUE(read_pickle(tuples + ".", "x.pkl").has_value());
  // A list that contains itself.
  EXPECT_TRUE(read_pickle("\x80\x02]q\0h\0a."s, "x.pkl").has_value());
  std::string marks = "\x80\x02" + std::string(3'000'000, '(');
  EXPECT_FALSE(read_pickle(marks + ".", "x.pkl").has_value());
  std::string nones = "\x80\x02" + std::string(3'000'000, 'N');
  EXPECT_THAT(pickle_error(nones + "."), HasSubstr("more than 2000000 values"));
}

// A long motion as lists of numbers, as MimicKit's files have it.
TEST(PickleTest, ReadsAsManyValuesAsTheFileHasBytesFor) {
  constexpr int kRows = 60'000, kNumbers = 35;
  PickleWriter pickle;
  pickle.begin_list();
  for (int row = 0; row < kRows; ++row) {
    pickle.begin_list();
    for (int i = 0; i < kNumbers; ++i) pickle.number(0.5 * i);
    pickle.end_list();
  }
  pickle.end_list();
  const std::string bytes = pickle.finish();
  const auto document = value_of(read_pickle(bytes, "x.pkl"));
  EXPECT_EQ(document.root().items.size(), std::size_t{kRows});
  // Values that need a single byte are too many for the size of their file.
  const std::string nones = "\x80\x02" + std::string(9'000'000, 'N');
  EXPECT_THAT(pickle_error(nones + "."), HasSubstr("more than 2250000 values"));
}

TEST(PickleTest, RejectsManyArraysOfOneBuffer) {
  // 4,000 bytes in the memo, and an array of them repeatedly.
  PickleWriter pickle;
  const std::vector<double> values(500, 1.0);
  pickle.array(float64_array(values, {500}));
  std::string once = pickle.finish();
  once.pop_back();
  const std::size_t data = once.find('\x8e');
  ASSERT_NE(data, std::string::npos);
  // Stores the bytes as value 7 and uses it instead of further copies.
  const std::string kept = once.substr(0, data + 9 + 4000) + "q\x07" + once.substr(data + 9 + 4000);
  const std::string again = once.substr(2, data - 2) + "h\x07" + once.substr(data + 9 + 4000);
  std::string bomb = "\x80\x04(" + kept.substr(2);
  for (int i = 0; i < 1000; ++i) bomb += again;
  EXPECT_THAT(pickle_error(bomb + "t."), HasSubstr("repeats its arrays too often"));
}

TEST(PickleTest, RejectsInconsistentArrays) {
  PickleWriter pickle;
  const std::vector<double> values = {1.0, 2.0};
  NpyArray array = float64_array(values, {2});
  array.shape = {3};
  pickle.array(array);
  EXPECT_THAT(pickle_error(pickle.finish()), HasSubstr("has an array of 16 bytes, expected 24"));
  PickleWriter overflow;
  array.shape = {std::size_t{1} << 62, 16};
  overflow.array(array);
  EXPECT_FALSE(read_pickle(overflow.finish(), "x.pkl").has_value());
}

std::string compressed(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf size = packed.size();
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 3);
  packed.resize(size);
  return packed;
}

TEST(PickleTest, ReadsCompressedJoblibFiles) {
  const std::string packed = compressed(two_arrays());
  ASSERT_TRUE(looks_like_pickle(packed));
  const auto read = value_of(read_pickle(packed, "x.pkl"));
  EXPECT_EQ(read.number(*read.find(read.root(), "fps")), 30.0);
  EXPECT_THAT(pickle_error(packed.substr(0, packed.size() / 2)), HasSubstr("damaged or cut off"));
  EXPECT_THAT(pickle_error(compressed("no pickle")),
              HasSubstr("the compressed file does not contain a pickle"));
}

TEST(PickleTest, RejectsDecompressionBombs) {
  // 9 MiB of zeros in 9 kB; 7 MiB are accepted at any ratio.
  EXPECT_THAT(pickle_error(compressed(std::string(std::size_t{9} << 20, '\0'))),
              HasSubstr("unpacked, the file has more than 8388608 bytes"));
  EXPECT_THAT(pickle_error(compressed(std::string(std::size_t{7} << 20, '\0'))),
              HasSubstr("does not contain a pickle"));
}

TEST(PickleTest, RejectsOldProtocolsByName) {
  for (const std::string& bytes :
       {"(dp0\nVfps\np1\nI30\ns."s,
        "}q\x00(X\x03\x00\x00\x00"
        "fpsK\x1eu."s,
        "(lp0\nI1\na."s, "cnumpy.core.multiarray\n_reconstruct\np0\n(I0\ntp1\nRp2\n."s}) {
    EXPECT_TRUE(looks_like_pickle(bytes));
    EXPECT_THAT(pickle_error(bytes), ::testing::AllOf(HasSubstr("has protocol 0 or 1"),
                                                      HasSubstr("pickle.dump(motion, file)")));
  }
  for (const char* text : {"count,x\n1,2.", "c\n1\n2.", "(1, 2)", "car, bus\n."}) {
    EXPECT_FALSE(looks_like_pickle(text)) << text;
  }
}

TEST(PickleTest, WritesStringsAsUtf8) {
  PickleWriter pickle;
  pickle.begin_dict();
  pickle.text("bad\xFF name");
  pickle.integer(1);
  pickle.end_dict();
  const std::string bytes = pickle.finish();
  const auto read = value_of(read_pickle(bytes, "x.pkl"));
  EXPECT_THAT(read.keys(read.root()), ::testing::ElementsAre("bad\xEF\xBF\xBD name"));
}

// joblib's array: wrapper, state, padding, raw bytes.
std::string joblib_array(const std::string& alignment, const std::string& after) {
  const auto text = [](const std::string& value) {
    return "\x8c" + std::string(1, static_cast<char>(value.size())) + value;
  };
  return "\x80\x04" + text("joblib.numpy_pickle") + text("NumpyArrayWrapper") + "\x93)\x81}(" +
         text("subclass") + text("numpy") + text("ndarray") + "\x93" + text("shape") +
         "K\x02K\x02\x86" + text("order") + text("F") + text("dtype") + text("numpy") +
         text("dtype") + "\x93" + text("f4") + "\x89\x88\x87R(K\x03" + text("<") +
         "NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xff"s + "K\0tb"s + text("allow_mmap") + "\x88" +
         alignment + "ub" + after;
}

TEST(PickleTest, ReadsJoblibArrays) {
  const std::vector<double> values = {1.0, 2.0, 3.0, 4.0};
  const std::string data = float32_array(values, {4}).data;
  const std::string aligned = "\x8c\x1bnumpy_array_alignment_bytesK\x10";
  for (const std::string& bytes :
       {joblib_array(aligned, "\x02\xff\xff" + data + "."), joblib_array("", data + ".")}) {
    const auto read = value_of(read_pickle(bytes, "x.pkl"));
    // Fortran order: the file has one column after the other.
    EXPECT_THAT(read.array(read.root()).numbers(), ::testing::ElementsAre(1, 3, 2, 4));
    EXPECT_FALSE(read_pickle(bytes.substr(0, bytes.size() - 3), "x.pkl").has_value());
  }
}

}  // namespace
}  // namespace retarget
