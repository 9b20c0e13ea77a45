#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "formats/bvh/source_text.h"
#include "retarget/error.h"

namespace retarget {

enum class NumberStatus : unsigned char {
  kOk,
  kMalformed,  ///< Not a number. `nan` and `inf` count as malformed.
  kTooLarge,   ///< A number beyond the range of double.
};

struct ParsedNumber {
  double value = 0.0;
  const char* end = nullptr;  ///< One past the last byte of the number; nullptr when malformed.
  NumberStatus status = NumberStatus::kMalformed;
};

/// Handles the cases outside the fast path of parse_number: many digits, exponents, malformed text.
[[nodiscard]] ParsedNumber parse_number_slow(const char* begin, const char* end);

/// Parses the number at `begin` with correct rounding (bit for bit like a correct strtod in the C
/// locale): sign, digits with an optional point (`5.` and `.5` are valid), optional exponent.
/// Values too small for double become denormal or zero. Never reads at or past `end`.
///
/// The caller checks which characters may follow a number.
[[nodiscard]] inline ParsedNumber parse_number(const char* begin, const char* end) {
  // Powers of ten that are exact. A quotient of two exact doubles is rounded only once, so it is
  // correct.
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

/// Whether a token is or begins with a spelling of NaN or infinity.
[[nodiscard]] bool is_nan_or_infinity(std::string_view token);

/// The error for a token that is not a number. It names common faults (decimal comma, NaN, a
/// missing space, a value out of range, a NUL byte) and gives a hint.
/// @param role  describes the number, such as `value 4 of 57 in row 2`.
[[nodiscard]] Failure number_failure(const SourceText& source, std::size_t offset,
                                     std::string_view role);

/// Space that a row needs beyond its count of values: fast readers check bounds only per block.
inline constexpr std::size_t kNumberLineSlack = 32;

/// Reads a line that holds only numbers separated by spaces or tabs.
///
/// Values are bit for bit those of parse_number. A reader may decline any line; the caller then
/// reads it number by number, which also locates errors.
/// @param text   the whole text.
/// @param begin  byte offset of the line's first value.
/// @param row    space for `count` values and kNumberLineSlack more, which may be overwritten.
/// @return byte offset of the line's end (its CR or LF, or the end of the text); npos when the
///     line is declined or does not hold exactly `count` numbers.
using ReadNumberLine = std::size_t (*)(std::string_view text, std::size_t begin, std::size_t count,
                                       std::span<double> row);

/// Reader for any processor.
[[nodiscard]] std::size_t read_number_line_portable(std::string_view text, std::size_t begin,
                                                    std::size_t count, std::span<double> row);

/// SIMD reader for this processor, or nullptr.
[[nodiscard]] ReadNumberLine vector_number_line_reader();

/// The fastest reader for this processor.
[[nodiscard]] ReadNumberLine fastest_number_line_reader();

}  // namespace retarget
