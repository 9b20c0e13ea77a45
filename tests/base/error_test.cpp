#include "retarget/error.h"

#include <gtest/gtest.h>

#include "base/option_name.h"

namespace retarget {
namespace {

TEST(Describe, StartsWithTheLocation) {
  Error error{ErrorKind::kInput, {"walk.bvh", 12, 7}, "expected a number, found \"x\"", {}, ""};
  EXPECT_EQ(describe(error), "walk.bvh:12:7: error: expected a number, found \"x\"");
  error.location.column = 0;
  EXPECT_EQ(describe(error), "walk.bvh:12: error: expected a number, found \"x\"");
  error.location.line = 0;
  EXPECT_EQ(describe(error), "walk.bvh: error: expected a number, found \"x\"");
}

TEST(Describe, OmitsUnknownParts) {
  EXPECT_EQ(describe(Error{ErrorKind::kUsage, {"", 0, 0}, "what", {}, ""}), "error: what");
  EXPECT_EQ(describe(Error{ErrorKind::kInput, {"", 3, 4}, "what", {}, ""}),
            "line 3:4: error: what");
  // A column without a line is not printed.
  EXPECT_EQ(describe(Error{ErrorKind::kInput, {"f", 0, 4}, "what", {}, ""}), "f: error: what");
}

TEST(Describe, PutsTheHintOnItsOwnLine) {
  EXPECT_EQ(describe(Error{ErrorKind::kUsage, {"", 0, 0}, "fault", {}, "do this"}),
            "error: fault\n  hint: do this");
}

TEST(Describe, ListsDetails) {
  const Error error{
      ErrorKind::kConfig, {"m.json", 0, 0}, "2 faults", {"one", "two"}, "repair them"};
  EXPECT_EQ(describe(error), "m.json: error: 2 faults\n  - one\n  - two\n  hint: repair them");
}

TEST(LocatedMessage, OmitsTheKind) {
  const Error error{
      ErrorKind::kConfig, {"m.json", 2, 3}, "2 faults", {"one"}, "see " OPTION("fps")};
  EXPECT_EQ(located_message(error, option_as_flag),
            "m.json:2:3: 2 faults\n  - one\n  hint: see --fps");
  EXPECT_EQ(located_message(Error{ErrorKind::kUsage, {"", 0, 0}, "what", {}, ""}), "what");
}

TEST(Describe, SpellsOptionsForTheAudience) {
  const Error error{ErrorKind::kInput,
                    {"a.bvh", 0, 0},
                    "no rate as " OPTION("fps") " asks",
                    {},
                    "give it with " OPTION("source-fps") " N"};
  EXPECT_EQ(describe(error),
            "a.bvh: error: no rate as fps asks\n  hint: give it with source_fps N");
  EXPECT_EQ(describe(error, option_as_flag),
            "a.bvh: error: no rate as --fps asks\n  hint: give it with --source-fps N");
  // Characters outside complete marks do not change.
  EXPECT_EQ(spell_options("a\x0e b"), "a\x0e b");
  EXPECT_EQ(spell_options("a\x0f b\x0e"), "a\x0f b\x0e");
}

TEST(Describe, FormatsWarnings) {
  EXPECT_EQ(describe(Warning{5, 2, "odd"}, "a.bvh"), "a.bvh:5:2: warning: odd");
  EXPECT_EQ(describe(Warning{0, 0, "odd"}, "a.bvh"), "a.bvh: warning: odd");
  EXPECT_EQ(describe(Warning{0, 0, "odd"}, ""), "warning: odd");
}

TEST(Failures, HaveKindFileAndMessage) {
  const auto fail = [](Failure failure) { return Result<int>(std::move(failure)).error(); };
  EXPECT_EQ(fail(input_failure("f", "m", "h")).kind, ErrorKind::kInput);
  EXPECT_EQ(fail(config_failure("f", "m")).kind, ErrorKind::kConfig);
  EXPECT_EQ(fail(usage_failure("m")).kind, ErrorKind::kUsage);
  EXPECT_EQ(fail(usage_failure("m")).location.file, "");
  const Error error = fail(run_failure("f", "m", "h"));
  EXPECT_EQ(error.kind, ErrorKind::kRun);
  EXPECT_EQ(error.location.file, "f");
  EXPECT_EQ(error.message, "m");
  EXPECT_EQ(error.hint, "h");
  EXPECT_EQ(error.location.line, 0U);
  EXPECT_EQ(error.location.column, 0U);
}

TEST(Results, HoldAValueOrAnError) {
  const auto half = [](int number) -> Result<int> {
    if (number % 2 != 0) return usage_failure("odd");
    return number / 2;
  };
  EXPECT_EQ(half(4).value(), 2);
  ASSERT_FALSE(half(3).has_value());
  EXPECT_EQ(half(3).error().message, "odd");
}

}  // namespace
}  // namespace retarget
