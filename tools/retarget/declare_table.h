#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

#include "options/option_table.h"

namespace retarget::cli {

/// Declares the rows of a table as options of a command. The structs that they are bound to must live
/// until the command line was parsed.
void declare(CLI::App& command, const OptionTable& rows);

/// A table without the rows of these names.
[[nodiscard]] OptionTable without(OptionTable rows, std::initializer_list<std::string_view> names);
/// The rows of these names alone.
[[nodiscard]] OptionTable only(OptionTable rows, std::initializer_list<std::string_view> names);

/// A table of one row under another name.
[[nodiscard]] OptionTable renamed(OptionTable rows, const char* name);

/// Longest time that an option may say, seconds: more than any motion, less than any slip.
inline constexpr double kLongestTime = 1e9;

/// A check without words of its own in the help: the option's own say what it takes.
[[nodiscard]] CLI::Validator silent(CLI::Validator validator);

/// A finite number in a range, with words of its own where it is not.
[[nodiscard]] CLI::Validator number_from(double least, double most);

/// Makes an empty word an error in place of a value, in all options of a command and its
/// subcommands: a shell's variable that is not set must not read as an option left out.
void refuse_empty_values(CLI::App& app);

}  // namespace retarget::cli
