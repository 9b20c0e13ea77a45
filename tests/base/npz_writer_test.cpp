#include "formats/containers/npz.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "retarget/zip.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::ElementsAre;

TEST(NpzWriterTest, RoundTrips) {
  const std::vector<double> values = {1.5, -2.0, 3.0, 0.1, 5.0, 6.0};
  const std::vector<std::int64_t> counts = {-1, 50};
  const std::vector<std::string> names = {"left", "a"};
  NpzWriter writer;
  writer.add("doubles", float64_array(values, {3, 2}));
  writer.add("floats", float32_array(values, {2, 3}));
  writer.add("counts", int64_array(counts, {2}));
  writer.add("names", text_array(names));
  writer.add("one", text_array({names.data(), 1}, true));
  const auto bytes = value_of(writer.finish());
  const auto npz = value_of(NpzFile::open(bytes, "x.npz"));
  EXPECT_THAT(npz.names(), ElementsAre("doubles", "floats", "counts", "names", "one"));
  EXPECT_THAT(npz.read("doubles")->numbers(), ElementsAre(1.5, -2.0, 3.0, 0.1, 5.0, 6.0));
  EXPECT_THAT(npz.read("doubles")->shape, ElementsAre(3, 2));
  EXPECT_EQ(npz.read("floats")->numbers()[3], static_cast<double>(0.1F));
  EXPECT_THAT(npz.read("counts")->numbers(), ElementsAre(-1, 50));
  EXPECT_THAT(npz.read("names")->texts(), ElementsAre("left", "a"));
  EXPECT_TRUE(npz.read("one")->shape.empty());
}

TEST(NpzWriterTest, StreamsGiveTheSameBytes) {
  const std::vector<double> values = {1.5, -2.0, 3.0, 0.1, 5.0, 6.0};
  const std::vector<std::string> names = {"gehen/\xC3\xA4", "\xE8\xB7\x91\xF0\x9F\x98\x80"};
  NpyArray array = float64_array(values, {3, 2});
  NpzWriter writer;
  writer.add("doubles", array);
  writer.add("names", text_array(names));
  const auto whole = value_of(writer.finish());

  std::string bytes;
  NpzStream stream([&bytes](std::string_view more) -> Result<void> {
    bytes += more;
    return {};
  });
  const std::string data = std::exchange(array.data, {});
  ZipChecksum first, elements;
  first.add(data.substr(16));
  elements.add(data.substr(0, 16));
  elements.append(first);
  ASSERT_TRUE(stream.begin("doubles", array, elements));
  ASSERT_TRUE(stream.write(data.substr(0, 16)));
  ASSERT_TRUE(stream.write(data.substr(16)));
  ASSERT_TRUE(stream.end());
  ASSERT_TRUE(stream.add("names", text_array(names)));
  ASSERT_TRUE(stream.finish());
  EXPECT_EQ(bytes, whole);
  const auto npz = value_of(NpzFile::open(bytes, "x.npz"));
  EXPECT_EQ(npz.read("names")->texts(), names);
}

TEST(NpzWriterTest, StreamsNameTheChange) {
  NpzStream stream([](std::string_view) -> Result<void> { return {}; });
  const std::vector<double> values = {1.5, -2.0};
  NpyArray array = float64_array(values, {2});
  ZipChecksum elements;
  elements.add(array.data);
  ASSERT_TRUE(stream.begin("doubles", array, elements));
  ASSERT_TRUE(stream.write(array.data.substr(1)));
  const auto ended = stream.end();
  ASSERT_FALSE(ended);
  EXPECT_NE(ended.error().message.find("doubles.npy"), std::string::npos);
}

TEST(NpzWriterTest, Zip64IsRead) {
  std::string bytes;
  // Treats plain fields as limited to less than 100.
  ZipStream stream(
      [&bytes](std::string_view more) -> Result<void> {
        bytes += more;
        return {};
      },
      100);
  const std::string large(300, 'x'), small(3, 'y');
  for (const std::string* content : {&small, &large, &small}) {
    ZipChecksum checksum;
    checksum.add(*content);
    ASSERT_TRUE(stream.begin(std::to_string(bytes.size()), checksum));
    ASSERT_TRUE(stream.write(*content));
    ASSERT_TRUE(stream.end());
  }
  ASSERT_TRUE(stream.finish());
  EXPECT_NE(bytes.find("PK\x06\x06"), std::string::npos);
  const auto archive = value_of(ZipArchive::open(bytes));
  ASSERT_EQ(archive.entries().size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string& content = i == 1 ? large : small;
    EXPECT_EQ(archive.entries()[i].size, content.size());
    auto reader = value_of(archive.entry_reader(i));
    EXPECT_EQ(*reader.read(content.size()), content);
    EXPECT_TRUE(reader.finish());
  }
}

TEST(NpzWriterTest, HeadersMatchNumpy) {
  const std::vector<double> values = {1.0};
  const std::string npy = format_npy(float32_array(values, {1}));
  EXPECT_EQ(npy.size() % 64, 4U);
  EXPECT_EQ(npy.substr(0, 8), std::string("\x93NUMPY\x01\0", 8));
  EXPECT_NE(npy.find("{'descr': '<f4', 'fortran_order': False, 'shape': (1,), }"),
            std::string::npos);
}

}  // namespace
}  // namespace retarget
