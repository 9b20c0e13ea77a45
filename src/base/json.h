#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "retarget/error.h"

namespace retarget {

/// Parses JSON; members keep their order, and of members by the same name the last one counts.
///
/// Syntax errors, numbers beyond the range of double, and what check_json_bounds refuses are kConfig
/// errors with line and column.
[[nodiscard]] Result<nlohmann::ordered_json> parse_json(std::string_view text,
                                                        const std::string& file);

/// parse_json of a file.
[[nodiscard]] Result<nlohmann::ordered_json> load_json(const std::string& path);

/// For people and other programs: two blanks a level, a line end at the end. What would command a
/// terminal, and bytes that are no UTF-8, are escaped or replaced.
[[nodiscard]] std::string printable_dump(const nlohmann::ordered_json& json);

/// A value for a message: as JSON, cut short where it is long.
[[nodiscard]] std::string short_text(const nlohmann::ordered_json& json);

}  // namespace retarget
