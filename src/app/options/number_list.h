#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace retarget {

/// Parses finite numbers separated by a character. Returns nothing unless all of them are valid.
[[nodiscard]] std::optional<std::vector<double>> numbers_in(std::string_view text, char separator);

}  // namespace retarget
