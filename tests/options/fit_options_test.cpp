// Options from JSON, terms by name.

#include "retarget/option_table.h"
#include "support/value_of.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace retarget {
namespace {

using testing::HasSubstr;

TEST(FitOptions, ReadsByName) {
  const auto options = value_of(parse_fit_options(
      R"({"floor": false, "hand_rotation": 20, "contact_time": 0.2, "iterations": 3})", "a.json"));
  EXPECT_FALSE(options.floor);
  EXPECT_EQ(options.weights.hand_rotation, 20.0);
  EXPECT_EQ(options.contact_time, 0.2);
  EXPECT_EQ(options.iterations, 3);
  // Other options do not change.
  EXPECT_EQ(options.weights.hips_rotation, FitOptions{}.weights.hips_rotation);
}

TEST(FitOptions, ReportsAllErrors) {
  const auto options = parse_fit_options(
      R"({"hand_rotaton": 1, "floor": 1, "window": -2, "iterations": 1.5, "soft_joint_speed": "x"})",
      "a.json");
  ASSERT_FALSE(options.has_value());
  const std::string text = describe(options.error());
  for (const char* part : {"hand_rotation", "\"floor\" must be true or false", "\"window\"",
                           "\"iterations\" must be a whole number", "\"soft_joint_speed\""}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_FALSE(parse_fit_options("[1]", "a.json").has_value());
  EXPECT_FALSE(parse_fit_options("{", "a.json").has_value());
}

TEST(FitOptions, DisablesTermsByName) {
  FitOptions options;
  ASSERT_TRUE(set_terms(options, std::vector<std::string>{"self-collision", "speed"}, false));
  EXPECT_FALSE(options.self_collision);
  EXPECT_FALSE(options.speed);
  EXPECT_TRUE(options.floor);
  const auto wrong = set_terms(options, std::vector<std::string>{"self-colision"}, false);
  ASSERT_FALSE(wrong.has_value());
  EXPECT_THAT(wrong.error().message, HasSubstr("self-collision"));
}

}  // namespace
}  // namespace retarget
