#include "base/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/processor_time.h"
#include "support/value_of.h"

namespace retarget {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

Error json_error(const std::string& text) {
  const auto json = parse_json(text, "file.json");
  EXPECT_FALSE(json.has_value());
  return json ? Error() : json.error();
}

void expect_at(const std::string& text, std::size_t line, std::size_t column) {
  const Error error = json_error(text);
  EXPECT_EQ(error.kind, ErrorKind::kConfig) << text;
  EXPECT_EQ(error.location.file, "file.json") << text;
  EXPECT_EQ(error.location.line, line) << text;
  EXPECT_EQ(error.location.column, column) << text;
}

TEST(JsonTest, KeepsMemberOrder) {
  const auto json = value_of(parse_json(R"({"z": 1, "a": 2, "m": 3})", "file.json"));
  EXPECT_EQ(json.dump(), R"({"z":1,"a":2,"m":3})");
}

TEST(JsonTest, SyntaxErrorsPointToTheFirstWrongByte) {
  expect_at("{\"a\": 1,}", 1, 9);
  expect_at("{\n  \"a\": 1\n  \"b\": 2\n}", 3, 5);  // The end of the last string that was read.
  expect_at("[1, 2", 1, 6);
  expect_at("[1,\n2\n", 3, 1);
  expect_at("", 1, 1);
  expect_at("[\"a\nb\"]", 1, 4);  // a line break within a text
}

TEST(JsonTest, MessageNamesTheExpectedValue) {
  EXPECT_THAT(json_error("{\"a\": }").message, HasSubstr("unexpected '}'"));
  EXPECT_THAT(json_error("<html>").message, HasSubstr("invalid literal"));
}

TEST(JsonTest, NumbersBeyondDoubleAreErrorsWithLocation) {
  expect_at("[1,\n 1e999]", 2, 2);
}

// For the parser, a zero byte ends the text.
TEST(JsonTest, TextAfterAZeroByteIsNotSearchedForKeys) {
  using std::string_view_literals::operator""sv;
  for (const std::string_view text :
       {"{}\0}"sv, "{\"a\": 1}\0\"x"sv, "[]\0:"sv, "{}\0{\"b\": 1, \"b\": 2}"sv}) {
    const auto found = parse_json(text, "file.json");
    if (found) EXPECT_TRUE(found->is_structured());
  }
}

TEST(JsonTest, RepeatedKeysAreErrorsAtTheSecondKey) {
  expect_at("{\"a\": 1,\n \"b\": {\"a\": 2},\n  \"a\": 3}", 3, 3);
  expect_at(R"([{"b": [{"x": 1, "y": {}, "x": 1}]}])", 1, 27);
  expect_at(R"({"a\"b": 1, "a\u0022b": 2})", 1, 13);  // Another spelling of the same key.
  EXPECT_THAT(json_error(R"({"speed": 1, "speed": 2})").message,
              HasSubstr("the key \"speed\" occurs twice in an object"));
  // Equal keys in different objects, and values that look like keys.
  for (const char* text : {R"([{"a": 1}, {"a": 2}])", R"({"a": "a", "b": ["a", "b", {"a": ":"}]})",
                           R"({"a": {"b": {"a": 1}}, "b": 1, "c": "{\"b\": 1}"})", R"({"": 1})",
                           R"({"\\": 1, "\"": 2})"}) {
    EXPECT_TRUE(parse_json(text, "file.json").has_value()) << text;
  }
}

TEST(JsonTest, InvalidUtf8IsAnError) {
  json_error("[\"\xff\"]");
}

TEST(JsonTest, DeepNestingIsAnErrorWithoutOverflow) {
  expect_at(std::string(1000000, '['), 1, 101);
  const std::string as_deep_as_allowed = std::string(100, '[') + std::string(100, ']');
  EXPECT_TRUE(parse_json(as_deep_as_allowed, "file.json").has_value());
  const std::string brackets_in_text = "[\"\\\"" + std::string(200, '[') + "\"]";
  EXPECT_TRUE(parse_json(brackets_in_text, "file.json").has_value());
}

// Returns `count` members with distinct names.
std::string object_of(int count) {
  std::string text = "{";
  for (int i = 0; i < count; ++i) text += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
  return text + "}";
}

TEST(JsonTest, TooManyMembersAreAnError) {
  EXPECT_TRUE(parse_json(object_of(2000), "file.json").has_value());
  const double begin = processor_time();
  EXPECT_THAT(json_error(object_of(200'000)).message,
              HasSubstr("an object of more than 2000 members"));
  std::string objects;
  for (int i = 0; i < 101; ++i) objects += (i > 0 ? "," : "[") + object_of(2000);
  EXPECT_THAT(json_error(objects + "]").message, HasSubstr("more than 200000 members in total"));
  EXPECT_LT(processor_time() - begin, 2);
  // Colons in text do not belong to a member.
  EXPECT_TRUE(parse_json("[\"" + std::string(5000, ':') + "\"]", "file.json").has_value());
}

TEST(JsonTest, TooLargeTextsAreAnError) {
  const std::string blanks(std::size_t{17} << 20, ' ');
  EXPECT_THAT(json_error(blanks + "{}").message, HasSubstr("more than 16777216 bytes"));
}

TEST(JsonTest, TruncatesLongTokensInMessages) {
  EXPECT_LT(json_error("[" + std::string(100000, 'x')).message.size(), 300U);
  EXPECT_LT(json_error("[\"" + std::string(100000, 'x')).message.size(), 300U);
}

TEST(JsonTest, ShortTextCutsAtCharacterBoundaries) {
  EXPECT_EQ(short_text({1, 2}), "[1,2]");
  std::string umlauts;
  for (int i = 0; i < 100; ++i) umlauts += "\xc3\xa4";
  const std::string text = short_text(umlauts);
  // A quote, 39 whole two-byte letters, the dots.
  EXPECT_THAT(text, SizeIs(1 + 39 * 2 + 3));
}

TEST(JsonTest, MissingFileIsAnError) {
  const auto json = load_json("no/such/file.json");
  ASSERT_FALSE(json.has_value());
  EXPECT_EQ(json.error().kind, ErrorKind::kConfig);
  EXPECT_EQ(json.error().location.file, "no/such/file.json");
}

}  // namespace
}  // namespace retarget
