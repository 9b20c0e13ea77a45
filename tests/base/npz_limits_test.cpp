// Archives with wrong sizes and damaged archives are rejected, with bounded memory and time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "base/npz_arrays.h"
#include "formats/containers/npz.h"
#include "support/npz_builder.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;

using Style = NpzBuilder::Style;

TEST(Npz, FalseSizesAllocateNothing) {
  // Header and directory both claim 2^40 bytes, which the archive lacks.
  const std::string array = npy("<u1", "(1099511627776,)", "12345678");
  Style style;
  style.zip64_central = true;
  style.claimed_size = static_cast<std::int64_t>(array.size() - 8) + 1099511627776;
  NpzReadOptions options;
  options.max_array_bytes = std::numeric_limits<std::size_t>::max();
  options.free_array_bytes = options.free_total_bytes = options.max_array_bytes;
  options.free_number_bytes = options.max_array_bytes;
  for (const bool compress : {false, true}) {
    style.compress = compress;
    const auto found = read_array(NpzBuilder().add("a", array, style).build(), "a", options);
    EXPECT_THAT(error_of(found),
                HasSubstr(compress ? "it is truncated: expected 1099511627776 bytes"
                                   : "it is not compressed, but has"));
  }
}

TEST(Npz, InflatesOnlyTheBytesOfTheShape) {
  const std::string zeros(std::size_t{1} << 20, '\0');
  Style style;
  style.compress = true;
  // Shape and directory claim eight bytes; a megabyte follows.
  const std::string array = npy("<u1", "(8,)", zeros);
  style.claimed_size = static_cast<std::int64_t>(array.size() - zeros.size() + 8);
  EXPECT_THAT(array_error(array, style), HasSubstr("its compressed data have the wrong length"));

  // The sizes are right, but exceed the caller's limit.
  style.claimed_size = -1;
  const std::string bytes = NpzBuilder().add("a", npy("<u1", "(1048576,)", zeros), style).build();
  EXPECT_LT(bytes.size(), zeros.size() / 100);
  NpzReadOptions options;
  options.max_array_bytes = zeros.size() - 1;
  EXPECT_THAT(error_of(read_array(bytes, "a", options)),
              HasSubstr("needs 1048576 bytes, at most 1048575 are allowed"));
  options.max_array_bytes = zeros.size();
  EXPECT_TRUE(read_array(bytes, "a", options).has_value());
}

TEST(Npz, MemoryLimitCountsDoubles) {
  // Three megabytes of bytes become twenty-four megabytes of doubles.
  const std::string zeros(std::size_t{3} << 20, '\0');
  const std::string array = npy("<u1", "(3145728,)", zeros);
  Style style;
  style.compress = true;
  const std::string packed = NpzBuilder().add("a", array, style).build();
  EXPECT_THAT(
      error_of(read_array(packed, "a", {})),
      HasSubstr("its 3145728 numbers need 25165824 bytes of memory, but the file has only"));
  EXPECT_TRUE(read_array(NpzBuilder().add("a", array).build(), "a", {}).has_value());
  NpzReadOptions options;
  options.max_number_bytes = (std::size_t{24} << 20) - 1;
  EXPECT_THAT(error_of(read_array(NpzBuilder().add("a", array).build(), "a", options)),
              HasSubstr("at most 25165823 are allowed"));
}

TEST(Npz, RejectsDecompressionBombs) {
  const std::string zeros(std::size_t{1} << 20, '\0');
  Style style;
  style.compress = true;
  const std::string array = npy("<u1", "(1048576,)", zeros);
  NpzReadOptions options;
  options.free_array_bytes = std::size_t{1} << 19;
  const std::string one = NpzBuilder().add("a", array, style).build();
  EXPECT_THAT(error_of(read_array(one, "a", options)),
              ::testing::AllOf(HasSubstr("array \"a\": its shape (1048576,) of <u1 needs 1048576 "
                                         "bytes, but the file has only"),
                               HasSubstr("compression ratio is implausible")));
  // Uncompressed members may be this large.
  EXPECT_TRUE(read_array(NpzBuilder().add("a", array).build(), "a", options).has_value());
  options.max_ratio = 2000;
  EXPECT_TRUE(read_array(one, "a", options).has_value());
  // Many small arrays: their total size is checked without unpacking.
  NpzBuilder builder;
  for (int i = 0; i < 20; ++i) builder.add("a" + std::to_string(i), array, style);
  NpzReadOptions of_many;
  of_many.free_total_bytes = std::size_t{16} << 20;
  EXPECT_THAT(error_of(read_array(builder.build(), "a0", of_many)),
              HasSubstr("unpacked, its arrays would have 209"));
  // The sum of the claims overflows.
  style.zip64_central = true;
  style.claimed_size = std::numeric_limits<std::int64_t>::max();
  NpzBuilder claims;
  for (int i = 0; i < 4; ++i) claims.add("a" + std::to_string(i), array, style);
  EXPECT_THAT(error_of(read_array(claims.build(), "a0", {})), HasSubstr("its arrays would have"));
}

// Reads all arrays of a file; errors must have a message and name the file.
void read_all(std::string_view bytes) {
  const ExactBytes exact(bytes);
  const Result<NpzFile> file = NpzFile::open(exact.view(), "a.npz");
  if (!file) {
    EXPECT_FALSE(file.error().message.empty());
    EXPECT_EQ(file.error().location.file, "a.npz");
    return;
  }
  for (const std::string& name : file->names()) {
    (void)file->type_of(name);
    const Result<NpyArray> array = file->read(name);
    if (!array) {
      EXPECT_FALSE(array.error().message.empty());
      continue;
    }
    EXPECT_LE(array->data.size(), 1000 * bytes.size());
    if (array->is_number()) (void)array->numbers();
    if (array->is_text()) (void)array->texts();
  }
}

std::vector<std::string> small_files() {
  std::vector<std::string> files;
  for (const bool compress : {false, true}) {
    Style style;
    style.compress = compress;
    style.zip64_central = compress;
    files.push_back(NpzBuilder()
                        .add("poses", npy("<f4", "(2, 3)", std::string(24, 'x'), true), style)
                        .add("gender", npy_text("male"), style)
                        .build(compress));
  }
  return files;
}

TEST(NpzRobustness, RejectsEveryTruncation) {
  for (const std::string& bytes : small_files()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const ExactBytes exact(std::string_view(bytes).substr(0, size));
      EXPECT_FALSE(NpzFile::open(exact.view(), "a.npz").has_value()) << size;
    }
  }
}

TEST(NpzRobustness, ReadsOrRejectsEveryChangedByte) {
  for (const std::string& bytes : small_files()) {
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (const int change : {0x01, 0x10, 0x80, 0xFF}) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ change);
        read_all(changed);
      }
    }
  }
}

}  // namespace
}  // namespace retarget
