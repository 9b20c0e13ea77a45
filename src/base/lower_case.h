#pragma once

#include <string>

namespace retarget {

/// A text with the capitals of ASCII made small; other bytes stay.
[[nodiscard]] std::string lower_case(std::string text);

}  // namespace retarget
