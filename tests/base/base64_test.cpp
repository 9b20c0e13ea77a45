#include "retarget/bytes.h"

#include <gtest/gtest.h>

#include <string>

namespace retarget {
namespace {

// RFC 4648, section 10
TEST(Base64Test, MatchesTheExamplesOfTheStandard) {
  const std::string bytes = "foobar";
  const char* texts[] = {"", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"};
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    EXPECT_EQ(base64_text(bytes.substr(0, size)), texts[size]);
    EXPECT_EQ(bytes_from_base64(texts[size]), bytes.substr(0, size));
  }
  EXPECT_EQ(bytes_from_base64("Zg"), "f");
  EXPECT_EQ(bytes_from_base64("/+8="), "\xff\xef");
}

TEST(Base64Test, RejectsInvalidTexts) {
  for (const char* text : {"Z", "Zg=a", "Zm 9", "Zm9v\n", "Zm9vZ", "===="}) {
    EXPECT_FALSE(bytes_from_base64(text)) << text;
  }
}

}  // namespace
}  // namespace retarget
