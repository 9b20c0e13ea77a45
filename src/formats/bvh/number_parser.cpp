#include "formats/bvh/number_parser.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <system_error>

namespace retarget {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// The properties of a number's text that distinguish overflow from underflow.
struct NumberShape {
  const char* end = nullptr;     // nullptr: not a number.
  bool zero = true;              // All digits are 0.
  std::ptrdiff_t magnitude = 0;  // The value is 0.d1d2... * 10^magnitude with d1 not 0.
};

// Larger exponents are equivalent: out of range.
constexpr std::ptrdiff_t kExponentCap = 1'000'000'000'000;

NumberShape measure(const char* at, const char* end) {
  NumberShape shape;
  bool any_digit = false;
  bool point = false;
  for (; at < end && (is_digit(*at) || (*at == '.' && !point)); ++at) {
    if (*at == '.') {
      point = true;
      continue;
    }
    any_digit = true;
    if (*at != '0') shape.zero = false;
    if (!point && !shape.zero) ++shape.magnitude;
    if (point && shape.zero) --shape.magnitude;
  }
  if (!any_digit) return {};
  if (at < end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool negative = at < end && *at == '-';
    if (negative || (at < end && *at == '+')) ++at;
    if (at == end || !is_digit(*at)) return {};
    std::ptrdiff_t exponent = 0;
    for (; at < end && is_digit(*at); ++at) {
      if (exponent < kExponentCap) exponent = 10 * exponent + (*at - '0');
    }
    shape.magnitude += negative ? -exponent : exponent;
  }
  shape.end = at;
  return shape;
}

}  // namespace

ParsedNumber parse_number_slow(const char* begin, const char* end) {
  // from_chars does not accept a plus sign.
  const bool plus = begin < end && *begin == '+';
  const bool negative = begin < end && *begin == '-';
  const char* unsigned_begin = plus || negative ? begin + 1 : begin;
  const NumberShape shape = measure(unsigned_begin, end);
  if (shape.end == nullptr) return {};

  double magnitude = 0.0;
  if (!shape.zero) {
    const auto [stop, error] = std::from_chars(unsigned_begin, shape.end, magnitude);
    const bool out_of_range = error == std::errc::result_out_of_range;
    if (!out_of_range && (error != std::errc() || stop != shape.end)) return {};
    if (out_of_range && shape.magnitude > 0) return {0.0, shape.end, NumberStatus::kTooLarge};
    if (out_of_range) magnitude = 0.0;
  }
  return {negative ? -magnitude : magnitude, shape.end, NumberStatus::kOk};
}

namespace {

struct Fault {
  std::string expected = "a number";
  std::string remark;  // Appended to the found token.
  std::string hint;
};

Fault comma_fault(std::string_view token) {
  const bool decimal = std::ranges::count(token, ',') == 1 &&
                       token.find('.') == std::string_view::npos && token.back() != ',';
  if (decimal) {
    return {"a number with a decimal point", " with a decimal comma",
            "use decimal points: replace the commas, or export with an English locale"};
  }
  return {"a number", "", "separate the values with spaces, not commas"};
}

Fault find_fault(std::string_view token, const ParsedNumber& number) {
  if (token.empty()) return {};
  if (token.front() == '\0') {
    return {"a number", "", "the file is damaged: part of it was overwritten with zeros"};
  }
  if (is_nan_or_infinity(token)) return {"a finite number", "", ""};
  if (number.status == NumberStatus::kTooLarge)
    return {"a number within the range of double", "", ""};
  if (token.find(',') != std::string_view::npos) return comma_fault(token);
  if (number.end != nullptr) {
    const std::string_view rest = token.substr(static_cast<std::size_t>(number.end - token.data()));
    if (rest.starts_with('-') || rest.starts_with('+')) {
      return {"a number followed by white space", "",
              "a space is missing before " + in_quotes(rest)};
    }
    return {"a number followed by white space", "", ""};
  }
  return {};
}

}  // namespace

bool is_nan_or_infinity(std::string_view token) {
  if (token.starts_with('-') || token.starts_with('+')) token.remove_prefix(1);
  return equal_ignoring_case(token.substr(0, 3), "nan") ||
         equal_ignoring_case(token.substr(0, 3), "inf") || token.starts_with("1.#");
}

Failure number_failure(const SourceText& source, std::size_t offset, std::string_view role) {
  Scanner scanner(source.text());
  scanner.move_to(offset);
  const std::string_view token = scanner.token();
  const Fault fault = find_fault(token, parse_number(token.data(), token.data() + token.size()));
  return source.failure_at(offset,
                           "expected " + fault.expected + " (" + std::string(role) + "), found " +
                               source.found_at(offset) + fault.remark,
                           fault.hint);
}

std::size_t read_number_line_portable(std::string_view text, std::size_t begin, std::size_t count,
                                      std::span<double> row) {
  const char* const end = text.data() + text.size();
  const char* at = text.data() + begin;
  const auto skip_blanks = [&] {
    while (at < end && is_space(*at) && !is_line_end(*at)) ++at;
  };
  for (std::size_t i = 0; i < count; ++i) {
    skip_blanks();
    const ParsedNumber number = parse_number(at, end);
    if (number.status != NumberStatus::kOk) return std::string_view::npos;
    at = number.end;
    if (at < end && !is_space(*at)) return std::string_view::npos;
    row[i] = number.value;
  }
  skip_blanks();
  if (at < end && !is_line_end(*at)) return std::string_view::npos;
  return static_cast<std::size_t>(at - text.data());
}

ReadNumberLine fastest_number_line_reader() {
  const ReadNumberLine reader = vector_number_line_reader();
  return reader != nullptr ? reader : read_number_line_portable;
}

}  // namespace retarget
