#pragma once

#include <span>
#include <string>
#include <string_view>

namespace retarget {

/// The candidate nearest to `name` in Damerau-Levenshtein distance (case counts half a step
/// as much as a wrong letter), or an empty string when none is near enough to be meant.
[[nodiscard]] std::string nearest_name(std::string_view name,
                                       std::span<const std::string> candidates);

/// ` (did you mean "X"?)` with a leading blank, or an empty string.
[[nodiscard]] std::string did_you_mean(std::string_view name,
                                       std::span<const std::string> candidates);

/// `a, b, c`; after `limit` names ` and N more`.
[[nodiscard]] std::string list_names(std::span<const std::string> names, std::size_t limit = 40);

}  // namespace retarget
