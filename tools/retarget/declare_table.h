#pragma once

#include <CLI/CLI.hpp>

#include <initializer_list>
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

/// The row of a word that is given without an option's name.
template <typename T>
Option word(const char* name, T& member, const char* type, const char* help, bool required = true) {
  return option(name, member, {.type = type, .help = help, .required = required});
}

/// Longest time that an option may say, seconds: more than any motion, less than any slip.
inline constexpr double kMaxTime = 1e9;

/// Makes an empty word an error in place of a value, in all options of a command and its
/// subcommands: a shell's variable that is not set must not read as an option left out.
void refuse_empty_values(CLI::App& app);

}  // namespace retarget::cli
