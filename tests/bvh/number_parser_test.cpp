#include "formats/bvh/number_parser.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace retarget {
namespace {

ParsedNumber parse(std::string_view text) {
  // A buffer of exactly the text's size, so that a sanitizer sees any read past it.
  const std::vector<char> bytes(text.begin(), text.end());
  ParsedNumber number = parse_number(bytes.data(), bytes.data() + bytes.size());
  if (number.end != nullptr) number.end = text.data() + (number.end - bytes.data());
  return number;
}

// The correctly rounded value from the C library.
void expect_same_as_strtod(const std::string& text) {
  char* stop = nullptr;
  const double expected = std::strtod(text.c_str(), &stop);
  const ParsedNumber number = parse(text);
  if (std::isinf(expected)) {
    EXPECT_EQ(number.status, NumberStatus::kTooLarge) << text;
    return;
  }
  ASSERT_EQ(number.status, NumberStatus::kOk) << text;
  EXPECT_EQ(number.end, text.data() + text.size()) << text;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(number.value), std::bit_cast<std::uint64_t>(expected))
      << text;
}

std::string printed(const char* format, double value) {
  std::string text(400, '\0');
  text.resize(std::snprintf(text.data(), text.size(), format, value));
  return text;
}

TEST(NumberParser, AcceptsEveryNumberFormat) {
  for (const char* text : {"0",
                           "-0",
                           "+0",
                           "-0.",
                           "+.5",
                           ".5",
                           "5.",
                           "-5.",
                           "1e0",
                           "1E+01",
                           "1e-3",
                           "007",
                           "0.0000",
                           "-.25e2",
                           "9007199254740993",
                           "9007199254740992",
                           "123456789012345678901234567890",
                           "0e999999999999999999999",
                           "1.7976931348623157e308",
                           "4.9406564584124654e-324",
                           "2.2250738585072011e-308",
                           "2.4703282292062327e-324",
                           "2.4703282292062328e-324",
                           "1e-400",
                           "-1e-99999999999999999999"}) {
    expect_same_as_strtod(text);
  }
}

TEST(NumberParser, RejectsTextThatIsNotANumber) {
  for (const char* text : {"", "-", "+", ".", "-.", "e5", ".e5", "1e", "1e+", "nan", "NaN", "inf",
                           "-inf", "infinity", "x", "--1", "+-1", "-+1", "{"}) {
    EXPECT_EQ(parse(text).status, NumberStatus::kMalformed) << text;
  }
}

TEST(NumberParser, RejectsNumbersOutOfRange) {
  for (const char* text : {"1e309", "-1e309", "1.8e308", "1e99999999999999999999999"}) {
    EXPECT_EQ(parse(text).status, NumberStatus::kTooLarge) << text;
  }
  EXPECT_EQ(parse(std::string(400, '9')).status, NumberStatus::kTooLarge);
  expect_same_as_strtod("1" + std::string(400, '0') + "e-400");
  expect_same_as_strtod("0." + std::string(400, '0') + "1e401");
}

TEST(NumberParser, StopsAtTheFirstOtherByte) {
  for (const char* text : {"2x0", "2 0", "2,5", "2-5", "2.5.5", "2e1e1", "0x10"}) {
    const std::string_view view = text;
    const ParsedNumber number = parse(view);
    EXPECT_EQ(number.status, NumberStatus::kOk) << text;
    EXPECT_LT(number.end, view.data() + view.size()) << text;
  }
}

TEST(NumberParser, MatchesStrtodBitForBitOnRandomText) {
  std::mt19937_64 random(20240611);
  std::uniform_real_distribution<double> degrees(-360.0, 360.0);
  for (int i = 0; i < 60000; ++i) {
    // Numbers as in files: with few digits and with many.
    const double value = degrees(random);
    expect_same_as_strtod(printed("%f", value));
    expect_same_as_strtod(printed("%.9g", value));
    expect_same_as_strtod(printed("%.17g", value));
  }
  for (int i = 0; i < 100000; ++i) {
    // Any double.
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    expect_same_as_strtod(printed("%.17g", value));
    expect_same_as_strtod(printed("%.5e", value));
  }
  for (int i = 0; i < 100000; ++i) {
    // Strings of digits around the limits of the fast path.
    std::string text(random() % 2 == 0 ? "-" : "");
    const int whole = static_cast<int>(random() % 12);
    const int decimals = static_cast<int>(random() % 25) + (whole == 0 ? 1 : 0);
    for (int d = 0; d < whole; ++d) text += static_cast<char>('0' + random() % 10);
    if (decimals > 0) text += '.';
    for (int d = 0; d < decimals; ++d) text += static_cast<char>('0' + random() % 10);
    expect_same_as_strtod(text);
  }
}

TEST(NumberParser, RoundsTiesToEven) {
  // Exactly half way between two doubles, and one digit beyond.
  std::mt19937_64 random(7);
  for (int i = 0; i < 2000; ++i) {
    const double low = std::ldexp(1.0 + std::ldexp(static_cast<double>(random() >> 12), -52),
                                  static_cast<int>(random() % 60) - 30);
    const double high = std::nextafter(low, std::numeric_limits<double>::infinity());
    const std::string half = [&] {
      std::string text(200, '\0');
      text.resize(std::snprintf(text.data(), text.size(), "%.100Lf",
                                (static_cast<long double>(low) + high) / 2.0L));
      return text;
    }();
    expect_same_as_strtod(half);
    expect_same_as_strtod(half + "1");
  }
}

}  // namespace
}  // namespace retarget
