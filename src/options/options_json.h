#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "options/option_table.h"
#include "retarget/error.h"

namespace retarget {

/// A text of bytes that need not be UTF-8, such as a file's name: what is none of it is replaced, and
/// KEY_hex beside has all bytes.
void put_name(nlohmann::ordered_json& json, const std::string& key, const std::string& bytes);

/// What put_name put there; empty where there is nothing.
[[nodiscard]] std::string name_from(const nlohmann::ordered_json& json, const std::string& key);

/// The options that decide a motion, in the table's order, also where they have their default.
[[nodiscard]] nlohmann::ordered_json options_json(const OptionTable& table);

/// Sets the options of a table that an object names; the others stay. All faults are named at once
/// (kConfig): unknown names with the nearest one, values of another kind or out of range. Numbers
/// that an option has while it is not given (0, -1) are in range.
/// @param what  the options, for messages: `the options of the fit`.
[[nodiscard]] Result<void> read_options(const nlohmann::ordered_json& json,
                                        const OptionTable& table, const std::string& file,
                                        const std::string& what);

}  // namespace retarget
