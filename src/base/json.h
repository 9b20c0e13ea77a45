#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "retarget/base/result.h"

namespace retarget {

/// Parses JSON; members keep their order. Syntax errors are kConfig errors with line and column.
[[nodiscard]] Result<nlohmann::ordered_json> parse_json(std::string_view text,
                                                        const std::string& file);

/// parse_json of a file.
[[nodiscard]] Result<nlohmann::ordered_json> load_json(const std::string& path);

}  // namespace retarget
