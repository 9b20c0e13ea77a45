#pragma once

#include <string>

namespace retarget {

/// A number with so many decimals, without trailing zeros: 9.97, 30. Never in exponents, the same
/// in every locale.
[[nodiscard]] std::string number_text(double value, int decimals);

}  // namespace retarget
