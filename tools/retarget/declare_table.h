#pragma once

#include <CLI/CLI.hpp>

#include <initializer_list>
#include <string_view>

#include "retarget/option_table.h"

namespace retarget::cli {

/// Declares the rows of a table as options of a command. The bound structs must outlive parsing.
void declare(CLI::App& command, const OptionTable& rows);

/// Returns a table without the rows of these names.
[[nodiscard]] OptionTable without(OptionTable rows, std::initializer_list<std::string_view> names);
/// Keeps only the rows of these names.
[[nodiscard]] OptionTable only(OptionTable rows, std::initializer_list<std::string_view> names);

/// Returns a table of one row under another name.
[[nodiscard]] OptionTable renamed(OptionTable rows, const char* name);

/// Returns the row of a positional argument.
template <typename T>
Option word(const char* name, T& member, const char* type, const char* help, bool required = true) {
  return option(name, member, {.type = type, .help = help, .required = required});
}

/// Largest time that an option accepts, seconds; longer than any motion, but catches typing errors.
inline constexpr double kMaxTime = 1e9;

/// Makes an empty argument an error in all options of a command and its subcommands: an unset shell
/// variable must not look like an omitted option.
void refuse_empty_values(CLI::App& app);

}  // namespace retarget::cli
