#pragma once

#include <string>

namespace retarget {

/// Returns the shortest text that parses back to the same number, without an exponent for ordinary
/// magnitudes.
[[nodiscard]] std::string number_text(double value);

/// Rounds to a number of decimals; never returns negative zero.
[[nodiscard]] double rounded(double value, int decimals);

/// Formats text as a JSON string, including quotes.
[[nodiscard]] std::string json_text(const std::string& text);

}  // namespace retarget
