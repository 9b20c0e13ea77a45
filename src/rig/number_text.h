#pragma once

#include <string>

namespace retarget {

/// The shortest text that reads back as the same number; no exponent for plain sizes.
[[nodiscard]] std::string number_text(double value);

/// To so many decimals; no negative zero.
[[nodiscard]] double rounded(double value, int decimals);

/// A text as a JSON string, quotes included.
[[nodiscard]] std::string json_text(const std::string& text);

}  // namespace retarget
