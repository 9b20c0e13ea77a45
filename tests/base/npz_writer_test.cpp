#include "base/npz_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "base/npz.h"

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
  const auto bytes = writer.finish();
  ASSERT_TRUE(bytes);
  const auto npz = NpzFile::open(*bytes, "x.npz");
  ASSERT_TRUE(npz) << describe(npz.error());
  EXPECT_THAT(npz->names(), ElementsAre("doubles", "floats", "counts", "names", "one"));
  EXPECT_THAT(npz->read("doubles")->numbers(), ElementsAre(1.5, -2.0, 3.0, 0.1, 5.0, 6.0));
  EXPECT_THAT(npz->read("doubles")->shape, ElementsAre(3, 2));
  EXPECT_EQ(npz->read("floats")->numbers()[3], static_cast<double>(0.1F));
  EXPECT_THAT(npz->read("counts")->numbers(), ElementsAre(-1, 50));
  EXPECT_THAT(npz->read("names")->texts(), ElementsAre("left", "a"));
  EXPECT_TRUE(npz->read("one")->shape.empty());
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
