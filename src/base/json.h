#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Parses JSON. Members keep their order; of duplicate keys the last one wins.
///
/// Returns kConfig errors with line and column for syntax errors, for numbers beyond the range of
/// double, and for text that check_json_bounds refuses.
[[nodiscard]] Result<nlohmann::ordered_json> parse_json(std::string_view text,
                                                        const std::string& file);

/// Reads and parses a JSON file; see parse_json.
[[nodiscard]] Result<nlohmann::ordered_json> load_json(const std::string& path);

/// Formats JSON with an indentation of two spaces and a final newline. Terminal control characters
/// are escaped, invalid UTF-8 is replaced.
[[nodiscard]] std::string printable_dump(const nlohmann::ordered_json& json);

/// A value as JSON for a message, truncated when it is long.
[[nodiscard]] std::string short_text(const nlohmann::ordered_json& json);

}  // namespace retarget
