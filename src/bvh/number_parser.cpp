#include "bvh/number_parser.h"

#include <charconv>
#include <system_error>

namespace retarget {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// the parts of a number's text that decide which way it leaves the range of double
struct NumberShape {
  const char* end = nullptr;     // nullptr: not a number
  bool zero = true;              // no digit but 0
  std::ptrdiff_t magnitude = 0;  // the value is 0.d1d2... * 10^magnitude with d1 not 0
};

// exponents beyond this are all the same: out of range
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
  // from_chars takes no plus sign
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

}  // namespace retarget
