#include "formats/bvh/number_parser.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace retarget {
namespace {

constexpr std::size_t kDeclined = std::string::npos;

// The result of a reader for a line in the middle of a text.
struct Line {
  bool taken = false;
  std::size_t end = 0;  // From the beginning of the line.
  std::vector<std::uint64_t> bits;

  bool operator==(const Line&) const = default;
};

Line read(ReadNumberLine reader, const std::string& line, std::size_t count) {
  // Text around the line must not matter: digits before it, numbers after it.
  const std::string before(40, '7');
  const std::string text = before + line + std::string(200, '8');
  std::vector<double> row(count + kNumberLineSlack, std::nan(""));
  const std::size_t end = reader(text, before.size(), count, row);
  Line result;
  result.taken = end != kDeclined;
  if (!result.taken) return result;
  result.end = end - before.size();
  for (std::size_t i = 0; i < count; ++i)
    result.bits.push_back(std::bit_cast<std::uint64_t>(row[i]));
  return result;
}

Line expected(const std::vector<std::string>& numbers, std::size_t end) {
  Line line{true, end, {}};
  for (const std::string& number : numbers) {
    line.bits.push_back(std::bit_cast<std::uint64_t>(std::strtod(number.c_str(), nullptr)));
  }
  return line;
}

class NumberLine : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    reader_ = GetParam() ? vector_number_line_reader() : read_number_line_portable;
    if (reader_ == nullptr) GTEST_SKIP() << "this processor has no vector reader";
  }
  ReadNumberLine reader_ = nullptr;
};

INSTANTIATE_TEST_SUITE_P(Readers, NumberLine, testing::Bool(),
                         [](const testing::TestParamInfo<bool>& parameter) {
                           return parameter.param ? "vector" : "portable";
                         });

TEST_P(NumberLine, HandlesEveryWidthAndPointPosition) {
  std::vector<std::string> numbers;
  const std::string digits = "987654321234567";
  for (std::size_t length = 1; length <= digits.size(); ++length) {
    for (std::size_t point = 0; point < length; ++point) {
      std::string number = digits.substr(0, length);
      if (point > 0) number[point - 1] = '.';
      // Readers may decline a trailing decimal point.
      if (number.back() == '.') continue;
      numbers.push_back(number);
      numbers.push_back("-" + number);
    }
  }
  for (const std::string zero : {"0", "-0", "0.000000", "-0.000000", ".0", "-.5", "00012.50"}) {
    numbers.push_back(zero);
  }
  // Every number at every position of a block of 64 bytes.
  for (std::size_t shift = 0; shift < 64; ++shift) {
    std::string line = "1" + std::string(shift + 1, ' ');
    for (const std::string& number : numbers) line += number + " ";
    std::vector<std::string> all = {"1"};
    all.insert(all.end(), numbers.begin(), numbers.end());
    EXPECT_EQ(read(reader_, line + "\n", all.size()), expected(all, line.size())) << shift;
  }
}

TEST_P(NumberLine, HandlesAllLineEndingsAndBlanks) {
  for (const std::string end : {"\n", "\r\n", "\r", " \n", "\t\r", "  \t \n"}) {
    const std::string line = "1.5\t-2.25 \t 3";
    const Line read_line = read(reader_, line + end, 3);
    EXPECT_EQ(read_line, expected({"1.5", "-2.25", "3"}, line.size() + end.find_first_of("\r\n")));
  }
}

TEST_P(NumberLine, DeclinesAWrongCount) {
  EXPECT_FALSE(read(reader_, "1 2 3\n4 5 6\n", 2).taken);
  EXPECT_FALSE(read(reader_, "1 2 3\n4 5 6\n", 4).taken);
  EXPECT_FALSE(read(reader_, std::string(300, '1') + "\n", 2).taken);
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "1 ";
  EXPECT_FALSE(read(reader_, many + "\n", 3).taken);
}

TEST_P(NumberLine, DeclinesTextThatIsNotANumber) {
  using namespace std::string_literals;
  for (const std::string& token : {"-"s,
                                   "."s,
                                   "-."s,
                                   "--1"s,
                                   "1-2"s,
                                   "1.2.3"s,
                                   "1..2"s,
                                   "1,5"s,
                                   "nan"s,
                                   "0x10"s,
                                   "1e"s,
                                   "#"s,
                                   "1;"s,
                                   "1/2"s,
                                   "1:2"s,
                                   "12a"s,
                                   "a12"s,
                                   "\xe2\x88\x92"s
                                   "5",
                                   "1\0002"s,
                                   "1\x01"s,
                                   "1\x7f"s,
                                   "\x80"s,
                                   "1\xb2"s,
                                   "999999999999999x"s,
                                   "1+2"s,
                                   "3.-"s}) {
    EXPECT_FALSE(read(reader_, "1.5 " + token + " 2.5\n", 3).taken) << token;
    EXPECT_FALSE(read(reader_, token + " 1.5 2.5\n", 3).taken) << token;
  }
}

// Readers may decline rarer forms but must not misread them.
TEST_P(NumberLine, ReadsOrDeclinesRareForms) {
  for (const std::string token :
       {"1e5", "-1.5E-3", "+2", "5.", "123456789012345678", "1e-320", "0.1234567890123456789",
        "9007199254740993", "-0.0000000000000001"}) {
    const std::string line = "1 " + token + " 2";
    const Line read_line = read(reader_, line + "\n", 3);
    if (read_line.taken) {
      EXPECT_EQ(read_line, expected({"1", token, "2"}, line.size())) << token;
    }
  }
}

TEST_P(NumberLine, ReadsRandomNumbers) {
  std::mt19937_64 random(20);
  std::normal_distribution<double> normal(0.0, 90.0);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::string> numbers;
    std::string line;
    for (int i = 0; i < 30; ++i) {
      const char* const formats[] = {"%.6f", "%.4f", "%.2f", "%.0f", "%.9f"};
      char text[64];
      std::snprintf(text, sizeof text, formats[random() % 5], normal(random));
      numbers.emplace_back(text);
      line += numbers.back() + (random() % 4 == 0 ? "  " : " ");
    }
    ASSERT_EQ(read(reader_, line + "\n", 30), expected(numbers, line.size())) << line;
  }
}

// Each reader may decline any line; lines that both accept must give equal numbers.
TEST(NumberLineReaders, AgreeOnRandomBytes) {
  const ReadNumberLine vector = vector_number_line_reader();
  if (vector == nullptr) GTEST_SKIP() << "this processor has no vector reader";
  std::mt19937 random(21);
  const std::string bytes = "0123456789..-- \t\n\r+eE\x01\xff,#";
  int taken = 0;
  for (int round = 0; round < 200'000; ++round) {
    std::string line;
    // Mostly digits; otherwise no line would be accepted.
    for (unsigned i = 0; i < 24; ++i) {
      const unsigned kind = random() % 100;
      line += kind < 70 ? bytes[random() % 10] : kind < 95 ? ' ' : bytes[random() % bytes.size()];
    }
    line += "\n";
    for (std::size_t count = 1; count <= 6; ++count) {
      const Line by_vector = read(vector, line, count);
      if (!by_vector.taken) continue;
      ++taken;
      ASSERT_EQ(by_vector, read(read_number_line_portable, line, count)) << line;
    }
  }
  EXPECT_GT(taken, 10'000);
}

// A text may end anywhere: the readers read nothing past its end (sanitizers detect it) and lose
// nothing.
TEST_P(NumberLine, HandlesEndsOfTexts) {
  std::string line = std::string(16, ' ');
  for (int i = 0; i < 40; ++i) line += "1.25 ";
  for (std::size_t size = 16; size <= line.size(); ++size) {
    // A buffer of exactly this size.
    const std::vector<char> text(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(size));
    std::vector<double> row(40 + kNumberLineSlack);
    const std::size_t end = reader_({text.data(), text.size()}, 16, 40, row);
    // The first digit of the last number is the minimum.
    if (end != kDeclined) {
      EXPECT_GE(size, 16 + 39 * 5 + 1U);
    }
  }
}

}  // namespace
}  // namespace retarget
