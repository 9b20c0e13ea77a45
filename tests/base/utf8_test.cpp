#include "retarget/text.h"

#include <gtest/gtest.h>

namespace retarget {
namespace {

TEST(Utf8, KeepsValidText) {
  for (const char* text : {"", "plain", "l\xC3\xA4uft", "\xE2\x82\xAC", "\xF0\x9F\x99\x82"}) {
    EXPECT_EQ(valid_utf8(text), text);
  }
}

TEST(Utf8, ReplacesInvalidBytes) {
  const std::string mark = "\xEF\xBF\xBD";
  EXPECT_EQ(valid_utf8("a\xFFz"), "a" + mark + "z");
  EXPECT_EQ(valid_utf8("\xC3"), mark);
  EXPECT_EQ(valid_utf8("\xE2\x82"), mark + mark);
  // Overlong, half of a surrogate pair, beyond U+10FFFF.
  EXPECT_EQ(valid_utf8("\xC0\x80"), mark + mark);
  EXPECT_EQ(valid_utf8("\xED\xA0\x80"), mark + mark + mark);
  EXPECT_EQ(valid_utf8("\xF4\x90\x80\x80"), mark + mark + mark + mark);
}

TEST(Utf8, HexRoundTrips) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  EXPECT_EQ(bytes_from_hex(hex_text(bytes)), bytes);
  EXPECT_EQ(hex_text("\xFF\n"), "ff0a");
  EXPECT_FALSE(bytes_from_hex("f").has_value());
  EXPECT_FALSE(bytes_from_hex("fg").has_value());
}

}  // namespace
}  // namespace retarget
