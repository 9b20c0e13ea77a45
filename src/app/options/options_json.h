#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "retarget/error.h"
#include "retarget/json.h"
#include "retarget/option_table.h"

namespace retarget {

/// The options that affect a motion, in table order, including those with default values.
[[nodiscard]] nlohmann::ordered_json options_json(const OptionTable& table);

/// Sets the options of a table from an object; other options are unchanged. All errors are reported
/// together (kConfig): unknown names with the nearest one, wrong types, values out of range. A
/// value that stands for "not given" (0, -1) is always accepted.
/// @param what  description for messages: `the options of the fit`.
[[nodiscard]] Result<void> read_options(const nlohmann::ordered_json& json,
                                        const OptionTable& table, const std::string& file,
                                        const std::string& what);

}  // namespace retarget
