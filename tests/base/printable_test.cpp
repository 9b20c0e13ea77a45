#include "retarget/text.h"

#include <gtest/gtest.h>

#include "retarget/error.h"

namespace retarget {
namespace {

TEST(Printable, KeepsPlainText) {
  for (const char* text :
       {"", "walk.bvh", "läuft ünd\tmehr\n", "日本語", "\xF0\x9F\x99\x82", "no UTF-8: \xE9\xFF"}) {
    EXPECT_EQ(printable(text), text);
    EXPECT_EQ(printable_json(text), text);
  }
}

TEST(Printable, ReplacesTerminalControlSequences) {
  EXPECT_EQ(printable("\x1b[2J\r\x07\x7f"), "?[2J???");
  // The one-byte and the Unicode form of ESC [.
  EXPECT_EQ(printable("a\x9b"
                      "2J"),
            "a?2J");
  EXPECT_EQ(printable("a\xC2\x9b"
                      "2J"),
            "a?2J");
  EXPECT_EQ(printable("\xE2\x80\xAE"
                      "gpj.exe"),
            "?gpj.exe");
  EXPECT_EQ(printable("\xE2\x81\xA6\xE2\x80\xA8\xD8\x9C\xE2\x80\x8F"), "????");
}

TEST(Printable, NamesInMessagesHaveOneLine) {
  EXPECT_EQ(without_line_feeds("a\nb\tc.csv"), "a?b\tc.csv");
  const Error error{ErrorKind::kInput, {"a\nerror: b.csv", 1, 0}, "fault", {}, "do this"};
  EXPECT_EQ(describe(error), "a?error: b.csv:1: error: fault\n  hint: do this");
  EXPECT_EQ(describe(Warning{0, 0, "odd"}, "a\nb"), "a?b: warning: odd");
}

TEST(Printable, KeepsJsonContent) {
  EXPECT_EQ(printable_json("{\"a\": \"\xC2\x9b\xE2\x80\xAE\x7f\"}"),
            "{\"a\": \"\\u009b\\u202e\\u007f\"}");
}

}  // namespace
}  // namespace retarget
