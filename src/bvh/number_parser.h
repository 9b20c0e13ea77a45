#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace retarget {

enum class NumberStatus : unsigned char {
  kOk,
  kMalformed,  ///< No number begins here. `nan` and `inf` are not numbers.
  kTooLarge,   ///< A number beyond the range of double.
};

struct ParsedNumber {
  double value = 0.0;
  const char* end = nullptr;  ///< Past the last byte of the number; nullptr when malformed.
  NumberStatus status = NumberStatus::kMalformed;
};

/// parse_number for what its fast path does not take: many digits, exponents, faults.
[[nodiscard]] ParsedNumber parse_number_slow(const char* begin, const char* end);

/// The number at `begin`, correctly rounded (bit for bit what a correct strtod gives in the C
/// locale): sign, digits with an optional point (`5.` and `.5` count), optional exponent. Values
/// too small for double become denormal or zero. Never reads at or past `end`.
///
/// The caller decides what may follow a number.
[[nodiscard]] inline ParsedNumber parse_number(const char* begin, const char* end) {
  // exact powers of ten: a quotient of two exact doubles is rounded once, so it is right
  static constexpr std::array<double, 23> kPowersOfTen = {
      1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr std::uint64_t kMaxExact = std::uint64_t{1} << 53;
  constexpr std::ptrdiff_t kDigitsWithoutOverflow = 19;

  const auto digit = [end](const char* at) {
    return at < end ? static_cast<unsigned>(static_cast<unsigned char>(*at)) - '0' : 10U;
  };
  const char* at = begin;
  const bool negative = at < end && *at == '-';
  if (negative || (at < end && *at == '+')) ++at;

  std::uint64_t mantissa = 0;
  const char* first = at;
  for (unsigned d = digit(at); d < 10; d = digit(++at)) mantissa = 10 * mantissa + d;
  std::ptrdiff_t digits = at - first;
  std::ptrdiff_t decimals = 0;
  if (at < end && *at == '.') {
    first = ++at;
    for (unsigned d = digit(at); d < 10; d = digit(++at)) mantissa = 10 * mantissa + d;
    decimals = at - first;
    digits += decimals;
  }
  const bool exponent = at < end && (*at == 'e' || *at == 'E');
  if (digits == 0 || digits > kDigitsWithoutOverflow || mantissa > kMaxExact || exponent) {
    return parse_number_slow(begin, end);
  }
  const double magnitude = static_cast<double>(mantissa) / kPowersOfTen[decimals];
  return {negative ? -magnitude : magnitude, at, NumberStatus::kOk};
}

}  // namespace retarget
