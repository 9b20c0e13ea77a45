#pragma once

#include <charconv>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace retarget {

/// A number with so many decimals, without trailing zeros: 9.97, 30. Never in exponents, the same
/// in every locale.
[[nodiscard]] std::string number_text(double value, int decimals);

/// The number that all of a text is, the same in every locale; nothing: it is none.
template <typename Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? std::optional(number) : std::nullopt;
}

/// The number that a text is, up to a million either way (metres, degrees, seconds: more than any
/// motion, less than any slip); nothing: it is none.
[[nodiscard]] std::optional<double> number_from_text(std::string_view text);

/// `1 frame`, `2 frames`.
[[nodiscard]] std::string count_text(std::integral auto count, std::string_view noun) {
  return std::to_string(count).append(" ").append(noun).append(count == 1 ? "" : "s");
}

}  // namespace retarget
