#include "retarget/text.h"

#include <array>
#include <charconv>
#include <cmath>

namespace retarget {

std::string number_text(double value, int decimals) {
  // The largest double has 309 digits before the point.
  std::array<char, 400> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                          std::chars_format::fixed, decimals);
  std::string text(digits.data(), end);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

std::optional<double> number_from_text(std::string_view text) {
  constexpr double kMaxExponent = 1e6;
  const auto value = parse_number<double>(text);
  return value && std::abs(*value) <= kMaxExponent ? value : std::nullopt;
}

}  // namespace retarget
