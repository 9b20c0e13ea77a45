#include "retarget/bytes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string_view>

namespace retarget {
namespace {

TEST(ByteReader, ReadsNumbersInBothOrders) {
  const std::string_view bytes("\x01\x02\xFF\xFE\x3F\x80\x00\x00", 8);
  ByteReader<std::endian::big> big(bytes);
  EXPECT_EQ(big.number<std::uint16_t>(), 0x0102);
  EXPECT_EQ(big.number<std::int16_t>(), -2);
  EXPECT_EQ(big.number<float>(), 1.0F);
  EXPECT_TRUE(big.ok());
  EXPECT_EQ(big.left(), 0U);
  ByteReader<std::endian::little> little(bytes);
  EXPECT_EQ(little.number<std::uint8_t>(), 1);
  EXPECT_EQ(little.number<std::uint8_t>(), 2);
  EXPECT_EQ(little.number<std::uint16_t>(), 0xFEFF);
  EXPECT_EQ(little.number<std::uint32_t>(), 0x0000803FU);
  EXPECT_TRUE(little.ok());
}

TEST(ByteReader, ReadsZeroBeyondTheEnd) {
  ByteReader<std::endian::little> reader("abc");
  EXPECT_EQ(reader.number<std::uint32_t>(), 0U);
  EXPECT_FALSE(reader.ok());
  EXPECT_EQ(reader.number<std::uint8_t>(), 0);
  EXPECT_EQ(reader.bytes(1), "");
  EXPECT_EQ(reader.text(), "");
  EXPECT_FALSE(reader.may_hold(0, 1));
}

TEST(ByteReader, TextsEndAtAZeroByte) {
  ByteReader<std::endian::little> reader(std::string_view("Hip\0Ab\0tail", 11));
  EXPECT_EQ(reader.text(), "Hip");
  EXPECT_EQ(reader.text(), "Ab");
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.text(), "");
  EXPECT_FALSE(reader.ok());
}

TEST(ByteReader, ChecksCountsAgainstTheSize) {
  ByteReader<std::endian::big> reader("12345678");
  EXPECT_TRUE(reader.may_hold(2, 4));
  EXPECT_FALSE(reader.may_hold(3, 4));
  EXPECT_FALSE(reader.may_hold(SIZE_MAX, 4));
}

TEST(BigEndian, IsAppended) {
  std::string bytes;
  append_big_endian(bytes, 0x01020304, 4);
  append_big_endian(bytes, 0xABCDEF, 2);
  EXPECT_EQ(bytes, std::string_view("\x01\x02\x03\x04\xCD\xEF", 6));
}

}  // namespace
}  // namespace retarget
