#pragma once

#include <string>
#include <string_view>

namespace retarget {

/// A number with so many decimals, without trailing zeros: 9.97, 30. Never in exponents, the same
/// in every locale.
[[nodiscard]] std::string number_text(double value, int decimals);

/// `1 frame`, `2 frames`.
[[nodiscard]] std::string count_text(long count, std::string_view noun);

}  // namespace retarget
