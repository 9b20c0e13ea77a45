#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace retarget {

/// A number with so many decimals, without trailing zeros: 9.97, 30. Never in exponents, the same
/// in every locale.
[[nodiscard]] std::string number_text(double value, int decimals);

/// The number that a text is, up to a million either way (metres, degrees, seconds: more than any
/// motion, less than any slip); nothing: it is none.
[[nodiscard]] std::optional<double> number_from_text(std::string_view text);

/// `1 frame`, `2 frames`.
[[nodiscard]] std::string count_text(long count, std::string_view noun);

}  // namespace retarget
